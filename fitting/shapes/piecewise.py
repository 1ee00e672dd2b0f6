"""Piecewise linear forms of one axis, with fixed knots."""

import itertools
from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
import numpy as np

from fitting.equation import equation_of, free_variable
from fitting.form import Form, Stage
from fitting.shapes.chebyshev_sums import require_finite
from fitting.shapes.exponential_sums import only_axis
from fitting.shapes.monomial_sums import free_letter
from integrals.reference import Axis, Reference
from programs.printing.formula import number_text


def piecewise_linear(
    reference: Reference,
    knots: int | Sequence[float] | np.ndarray,
    *,
    name: str,
    axes: tuple[Axis, ...] | None = None,
) -> Form:
    """Return the form that is linear between knots of one axis; c0, c1 … are its values there.

    `knots` are increasing places on the axis, or their number: they are then distributed as the
    axis's `scale` says, the ends included. The form is constant before the first and after the last
    knot. It is linear in the coefficients, and has no divisor. Raises ValueError for more than one
    axis, for knots that are not increasing or are outside the domain, and for less than two.
    """
    axes = reference.axes if axes is None else axes
    axis = only_axis(name, axes)
    x = _places(name, knots, axis)
    letter = free_letter("c", [axis.name, axis.symbol])
    names = [f"{letter}{k}" for k in range(len(x))]

    def value(c, at) -> Any:
        total = jnp.asarray(c[0])
        # Each piece is a ramp from 0 to 1. Outside its piece it is exactly 0 or 1, so that an
        # interval bound of the sum is no wider than that of one piece.
        for k, (left, right) in enumerate(itertools.pairwise(x)):
            ramp = (at - left) * (1 / (right - left))
            if left > axis.lower:
                ramp = jnp.maximum(ramp, 0.0)
            if right < axis.upper:
                ramp = jnp.minimum(ramp, 1.0)
            total = total + (c[k + 1] - c[k]) * ramp
        return total

    v = free_variable([axis.name, axis.symbol])
    parts = [
        f"({names[k + 1]} − {names[k]})"
        f"·ramp({_difference(axis.symbol, left)}/{number_text(right - left)})"
        for k, (left, right) in enumerate(itertools.pairwise(x))
    ]
    text = " + ".join([names[0], *parts])
    equation = equation_of(reference.symbol, text, [f"ramp({v}) = min(max({v}, 0), 1)"])
    return Form(name, equation, reference, axes, names, (Stage(value),))


def _difference(symbol: str, left: float) -> str:
    sign = "−" if left > 0 else "+"
    return f"({symbol} {sign} {number_text(abs(left))})" if left else symbol


def _places(name: str, knots, axis: Axis) -> list[float]:
    if isinstance(knots, int | np.integer):
        require_finite(name, axis)
        places = axis.place(np.linspace(0, 1, max(knots, 0)))
    else:
        places = np.asarray(knots, float)
    if places.ndim != 1 or len(places) < 2:
        raise ValueError(f"{name}: {np.size(places)} knots: at least 2 are needed")
    if not (np.isfinite(places).all() and (np.diff(places) > 0).all()):
        raise ValueError(f"{name}: knots {places.tolist()}: allowed are increasing finite numbers")
    for outside in (each for each in places if not axis.lower <= each <= axis.upper):
        raise ValueError(f"{name}: knot {outside:g}: allowed are {axis.domain} of {axis.name}")
    return places.tolist()
