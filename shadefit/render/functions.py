"""The four functions of the fuzz BRDF by name: exact, or any set of tables."""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import jax.numpy as jnp
from jax import Array

from coefficients.catalogue import form_of, load, names
from fitting import Form
from integrals import PS, G, Q, R
from integrals.fuzz.ps import scattered_fraction


@dataclass(frozen=True)
class Functions:
    """P_s(c, a, b, α, θf) of the cosines u·n, u·t, n·t; G(d, ν), Q(d) and R(α, θf)."""

    ps: Callable[..., Array]
    g: Callable[..., Array]
    q: Callable[..., Array]
    r: Callable[..., Array]


SETS = ("published", "refitted", "best")


def table_sets() -> tuple[str, ...]:
    """Name the sets that have a table of each quantity."""
    return tuple(name for name in SETS if all(table_of(name, x.name) for x in (PS, G, Q, R)))


@functools.cache
def table_of(name: str, quantity: str) -> str | None:
    """Name a set's table of a quantity; None if there is none.

    'best' is of all forms that are not the paper's the one with the least rms error.
    """
    if name != "best":
        found = f"published/{quantity}" if name == "published" else quantity
        return found if found in names() else None
    errors = {
        each: table.errors.off_grid.rms
        for each, table in ((each, load(each)) for each in names() if each.startswith("best/"))
        if table.quantity == quantity and table.errors is not None
    }
    return min(errors, key=errors.__getitem__, default=None)


def functions(name: str) -> Functions:
    """Give the four functions by name: 'exact', or tables as 'published', 'refitted', 'best'.

    A table's arguments are clamped to its form's domain, as the listings do.
    """
    if name == "exact":
        exact_ps = lambda c, a, b, alpha, _: scattered_fraction(c, a, b, alpha)  # noqa: E731
        return Functions(exact_ps, G.value, Q.value, R.value)
    ps, g, q, r = (clamped(form_of(load(str(table_of(name, x.name))))) for x in (PS, G, Q, R))
    return Functions(lambda c, a, b, *m: ps(*m, *_angles(c, a, b)), g, q, r)


def clamped(form: Form) -> Callable[..., Array]:
    """Give a form as a function whose arguments are first brought into the form's domain."""

    def evaluate(*arguments):
        inside = [
            jnp.clip(x, axis.lower, axis.upper)
            for x, axis in zip(arguments, type(form).axes, strict=True)
        ]
        return form(*inside)

    return evaluate


def _angles(cos_un: Array, cos_ut: Array, cos_nt: Array) -> tuple[Array, Array]:
    """Give θu and |φ| from the cosines; forms of P_s are even in φ."""
    sines = jnp.sqrt(jnp.maximum((1 - cos_un**2) * (1 - cos_nt**2), 1e-24))
    return jnp.arccos(cos_un), jnp.arccos(jnp.clip((cos_ut - cos_un * cos_nt) / sines, -1, 1))
