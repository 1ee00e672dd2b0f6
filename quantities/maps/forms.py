"""Forms of the widening of filtered lobes: quotients of polynomials in the shares of the spread.

Without a spread the lobe stays as it is: w = 1 at u = 0 is built into every form. A linear function
contains the filters in print: SGGX filtering is w = 1, and LEAN mapping is w = 1 + u.
"""

import functools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Stage
from fitting.shapes.rationals import rational
from integrals.maps.references import SGGX_FILTER, SGGX_FILTER_AXES
from shading.types import Scalar

MOST_TERMS = 4

LINEAR = Form(
    name="linear-sggx-filter",
    equation="w = 1 + C[0]·u",
    reference=SGGX_FILTER,
    axes=SGGX_FILTER.axes,
    coefficient_names=["c0: u"],
    stages=(Stage(lambda c, share: jnp.asarray(1 + c[0] * share)),),
)


def _linear_axes(c, along: Scalar, across: Scalar) -> Array:
    return jnp.asarray(1 + c[0] * along + c[1] * across)


LINEAR_AXES = Form(
    name="linear-sggx-filter-axes",
    equation="w₁ = 1 + C[0]·u₁ + C[1]·u₂",
    reference=SGGX_FILTER_AXES,
    axes=SGGX_FILTER_AXES.axes,
    coefficient_names=["c0: u₁", "c1: u₂"],
    stages=(Stage(_linear_axes),),
)


@functools.cache
def filter_form(*, above: int, below: int) -> Form:
    """Return w = 1 + u (a₀ + …)/(1 + b₁u + …) with `above` and `below` coefficients."""
    form = rational(
        SGGX_FILTER,
        range(above),
        range(below + 1),
        name="quotient-sggx-filter",
        times=lambda share: share,
        plus=lambda: 1.0,
    )
    return replace(form, shape={"above": above, "below": below})


@functools.cache
def axes_form(*, numerator: Sequence, denominator: Sequence) -> Form:
    """Return w₁ = 1 + N/D; N has the given monomials of u₁ and u₂, D the constant 1 and others.

    Raises ValueError for a constant in N, because w₁ = 1 without a spread.
    """
    if (0, 0) in numerator:
        raise ValueError("numerator = … (0, 0) …: allowed are other monomials, as w₁ = 1 at u = 0")
    form = rational(
        SGGX_FILTER_AXES,
        numerator,
        [(0, 0), *denominator],
        name="quotient-sggx-filter-axes",
        plus=lambda: 1.0,
    )
    shape = {"numerator": list(map(list, numerator)), "denominator": list(map(list, denominator))}
    return replace(form, shape=shape)


_QUADRATIC = ((1, 0), (0, 1), (2, 0), (1, 1))
CHOSEN = (
    (_QUADRATIC, ((1, 0), (0, 1))),
    (_QUADRATIC, ((1, 0), (0, 1), (2, 0))),
    (_QUADRATIC, ((1, 0), (0, 1), (2, 0), (0, 2))),
    ((*_QUADRATIC, (2, 2)), ((1, 0), (0, 1), (2, 0), (0, 2))),
)


def candidates() -> Iterator[Form]:
    """Yield the forms that a search tries for an even spread."""
    for above in range(1, MOST_TERMS + 1):
        for below in range(above + 2):
            yield filter_form(above=above, below=min(below, MOST_TERMS))


def axes_candidates() -> Iterator[Form]:
    """Yield the forms that a search tries for two axes."""
    for numerator, denominator in CHOSEN:
        yield axes_form(numerator=numerator, denominator=denominator)
