"""Forms of Q: a polynomial and poles, combined with the known behaviour of Q at d = 0.

Q = 1 − 2d − d² ln d + O(d²). Because of the logarithm, polynomials and rational functions of d
approximate Q badly near d = 0.
"""

import functools
import itertools
from collections.abc import Iterator

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import FittedForm, Form, Proofs, Stage, Wider
from fitting.shapes.poles import (
    among_poles,
    least_offset,
    pole_names,
    pole_starts,
    poles_text,
    poles_value,
    quotient_of_poles,
)
from integrals import Q
from integrals.reference import restricted
from shading.types import Scalar

AXES = restricted(Q.axes, density=(0.0, 0.5))
# The logarithm is that of max(d, this), so that it is finite at d = 0. Its factor d² makes the
# difference far smaller than rounding.
LEAST_DENSITY = 1e-7

# Poles are farther than this from x = 0, so that no precision of shaders turns one into a division
# by zero.
_LEAST_OFFSET = 5e-4

# A search tries up to this many terms and poles. All its forms of a structure are evaluated by the
# one that has the most of both.
MOST_TERMS, MOST_POLES = 4, 2

# The equation of each structure, in which {0} is the polynomial with the poles, and the variable of
# that polynomial
STRUCTURES = {
    "free": ("{0}", "d"),
    "one": ("1 + d·({0})", "d"),
    "slope": ("1 + d·(d·({0}) − 2)", "√d"),
    "log": ("1 + d·(d·({0} − ln(max(d, 1e-7))) − 2)", "d"),
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
    """Return the form of Q with a structure of STRUCTURES.

    r is the sum of a polynomial with `terms` coefficients and of `poles` poles aₖ/(bₖ + x), where x
    is d or √d. Raises ValueError if both numbers are 0.
    """
    if terms + poles == 0:
        raise ValueError("terms + poles = 0: at least one is needed")
    wider = None
    if terms <= MOST_TERMS and poles <= MOST_POLES:
        places = among_poles((terms, poles), (MOST_TERMS, MOST_POLES))
        wider = Wider(_widest(structure), *places)
    return _pole_form(structure, terms, poles, wider)


@functools.cache
def _widest(structure: str) -> Form:
    return _pole_form(structure, MOST_TERMS, MOST_POLES, None)


def _pole_form(structure: str, terms: int, poles: int, wider: Wider | None) -> Form:
    def value(c, density: Scalar) -> Array:
        return _surround(structure, jnp.asarray(density), lambda x: poles_value(c, terms, poles, x))

    text, variable = STRUCTURES[structure]
    return Form(
        name="pole-q",
        equation=f"Q = {text.format(poles_text(terms, poles, variable))}",
        reference=Q,
        axes=AXES,
        coefficient_names=pole_names(terms, poles),
        stages=(Stage(value),),
        starts=pole_starts(terms, poles),
        shape={"structure": structure, "terms": terms, "poles": poles},
        proofs=Proofs(
            positive=lambda c, _: least_offset(c, terms, poles) - _LEAST_OFFSET,
            quotient=functools.partial(_as_quotient, structure, terms, poles) if poles else None,
        ),
        wider=wider,
    )


def _as_quotient(structure: str, terms: int, poles: int, fitted: FittedForm) -> FittedForm:
    """Return the same values with r as a quotient of polynomials, which any other one may replace.

    The coefficients are those of the numerator, in rising powers, then those of the denominator but
    for the highest power, whose coefficient is 1.
    """
    above, below = quotient_of_poles(fitted.constants, terms, poles)
    split, most, wider = len(above), MOST_TERMS + poles, None
    if split <= most:
        places = (*range(split), *range(most, most + poles))
        wider = Wider(_widest_quotient(structure, poles), places, (0.0,) * (most + poles))
    form = _quotient(structure, split, poles, wider)
    return form.fitted(np.concatenate([above, below[:-1]]))


@functools.cache
def _widest_quotient(structure: str, poles: int) -> Form:
    return _quotient(structure, MOST_TERMS + poles, poles, None)


def _quotient(structure: str, split: int, poles: int, wider: Wider | None) -> Form:
    """Return the form with a quotient of polynomials: `split` coefficients above, degree `poles`.

    The highest power of the denominator has the coefficient 1.
    """

    def value(c, density: Scalar) -> Array:
        def r(x):
            lower = sum(c[split + k] * x**k for k in range(poles))
            return sum(c[k] * x**k for k in range(split)) / (x**poles + lower)

        return _surround(structure, jnp.asarray(density), r)

    return Form(
        name="quotient-q",
        equation=f"{structure}, with a quotient of polynomials",
        reference=Q,
        axes=AXES,
        coefficient_names=[f"n{k}" for k in range(split)] + [f"d{k}" for k in range(poles)],
        stages=(Stage(value),),
        wider=wider,
    )


def candidates() -> Iterator[Form]:
    """Yield the forms of Q that a search tries."""
    for structure, terms, poles in itertools.product(
        STRUCTURES, range(MOST_TERMS + 1), range(MOST_POLES + 1)
    ):
        if terms + poles > (structure == "free") and not (structure == "log" and poles):
            yield pole_q(structure=structure, terms=terms, poles=poles)
