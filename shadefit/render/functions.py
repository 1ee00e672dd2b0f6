"""The four functions that the fuzz BRDF needs, exact or from a set of tables.

Tables are evaluated by their exported functions, with the same arguments and clamps as in a shader.
Renderings and the ambient model therefore show what the exported code computes.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

from jax import Array

import integrals
from coefficients.catalogue import Entry, entries, published, refitted
from quantities import Problem
from quantities.fuzz.g import G
from quantities.fuzz.ps import PS
from quantities.fuzz.q import Q
from quantities.fuzz.r import R
from shading.fuzz.lit_cone import scattered_fraction


# Compared and hashed by identity (eq=False): JAX takes it as a static argument.
@dataclass(frozen=True, eq=False)
class Functions:
    """P_s, G, Q and R as JAX functions of scalars.

    * `name`: 'exact', or the name of a set of tables.
    * `ps(cos_un, cos_ut, cos_nt, alpha, theta_f)`: P_s for light from u. The cosines are u·n, u·t
      and n·t; theta_f, in radians, is the polar angle of the fibre t, so that n·t = cos θf. The
      closed form uses n·t, tables use θf.
    * `g(density, cos_v)`, `q(density)`, `r(alpha, theta_f)`.
    """

    name: str
    ps: Callable[..., Array]
    g: Callable[..., Array]
    q: Callable[..., Array]
    r: Callable[..., Array]


EXACT = Functions(
    "exact",
    ps=lambda cos_un, cos_ut, cos_nt, alpha, _: scattered_fraction(cos_un, cos_ut, cos_nt, alpha),
    g=integrals.G.value,
    q=integrals.Q.value,
    r=integrals.R.value,
)


def best(owner: Problem) -> Entry | None:
    """Return the table of kind 'best' with the least rms error; None if there is none."""
    measured = [
        (entry.table.errors.off_grid.rms, entry)
        for entry in entries(owner)
        if entry.kind == "best" and entry.table is not None and entry.table.errors is not None
    ]
    return min(measured, key=lambda pair: pair[0])[1] if measured else None


# Each set takes one table of a quantity, or None where there is no such table.
CHOICES: dict[str, Callable[[Problem], Entry | None]] = {
    "published": published,
    "refitted": refitted,
    "best": best,
}


@functools.cache
def table_sets() -> tuple[Functions, ...]:
    """Return the functions of every set that has a table of each quantity.

    Every call returns the same objects, so that JAX compiles once for each set.
    """
    found = []
    for name, choose in CHOICES.items():
        chosen = [entry for entry in map(choose, (PS, G, Q, R)) if entry is not None]
        if len(chosen) == 4:
            found.append(exported_functions(name, *chosen))
    return tuple(found)


def exported_functions(name: str, ps: Entry, g: Entry, q: Entry, r: Entry) -> Functions:
    """Return the exported functions of four tables in float64, clamps included."""
    material, direction = (each.call for each in ps.functions("double"))
    (call_g,), (call_q,), (call_r,) = (entry.functions("double") for entry in (g, q, r))
    return Functions(
        name,
        ps=lambda cos_un, cos_ut, _, alpha, theta_f: direction(
            material(alpha, theta_f), cos_un, cos_ut
        ),
        # The exported function takes v·n first.
        g=lambda density, cos_v: call_g.call(cos_v, density),
        q=call_q.call,
        r=call_r.call,
    )
