"""Forms of Q in one variable: a polynomial and poles, inside what is known of Q at d = 0.

Q = 1 − 2d − d² ln d + O(d²): near d = 0 neither polynomials nor rational functions of d follow it.
"""

import functools
import itertools
from collections.abc import Iterator

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Proofs, Stage
from fitting.shapes.poles import least_offset, pole_names, pole_starts, poles_value
from integrals import Q
from integrals.reference import restricted
from shading.types import Scalar

AXES = restricted(Q.axes, density=(0.0, 0.5))
# ln d is taken of at least this; its factor d² is far below rounding there.
LEAST_DENSITY = 1e-30

# What surrounds the polynomial and the poles r, and the variable that they are of.
STRUCTURES = {
    "free": "r(d)",
    "one": "1 + d r(d)",
    "slope": "1 + d (d r(√d) − 2)",
    "log": "1 + d (d (r(d) − ln d) − 2)",
}


def _surround(structure: str, d: Array, r) -> Array:
    if structure == "free":
        return r(d)
    if structure == "one":
        return 1 + d * r(d)
    if structure == "slope":
        return 1 + d * (d * r(jnp.sqrt(d)) - 2)
    return 1 + d * (d * (r(d) - jnp.log(jnp.maximum(d, LEAST_DENSITY))) - 2)


@functools.cache
def pole_q(*, structure: str, terms: int, poles: int) -> Form:
    """Return the form of Q with a polynomial of `terms` and as many `poles` aₖ/(bₖ + x).

    Raises ValueError for a form of neither.
    """
    if terms + poles == 0:
        raise ValueError("terms + poles = 0: at least one is needed")

    def value(c, density: Scalar) -> Array:
        return _surround(structure, jnp.asarray(density), lambda x: poles_value(c, terms, poles, x))

    return Form(
        name="pole-q",
        equation=f"Q = {STRUCTURES[structure]}, r a polynomial of {terms} terms and {poles} poles",
        reference=Q,
        axes=AXES,
        coefficient_names=pole_names(terms, poles),
        stages=(Stage(value),),
        starts=pole_starts(terms, poles),
        shape={"structure": structure, "terms": terms, "poles": poles},
        proofs=Proofs(positive=lambda c, _: least_offset(c, terms, poles)),
        # Some are linear, but the solver's tolerance of 1e-7 hides their errors: no bound is sound.
        has_least_error=False,
    )


def candidates() -> Iterator[Form]:
    """Yield the forms of Q that a search tries."""
    for structure, terms, poles in itertools.product(STRUCTURES, range(5), range(3)):
        if terms + poles > (structure == "free") and not (structure == "log" and poles):
            yield pole_q(structure=structure, terms=terms, poles=poles)
