"""Piecewise linear forms, with fixed knots: on one axis, or on a tensor grid of several."""

import itertools
from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
import numpy as np

from fitting.equation import equation_of, free_variable
from fitting.form import Form, Stage
from fitting.shapes.chebyshev_sums import require_finite
from fitting.shapes.monomial_sums import coefficient_name, free_letter
from integrals.reference import Axis, Reference
from programs.printing.formula import number_text


def piecewise_linear(
    reference: Reference,
    knots: int | Sequence | np.ndarray,
    *,
    name: str,
    axes: tuple[Axis, ...] | None = None,
) -> Form:
    """Return the form that is linear in each axis between its knots; its coefficients are values.

    `knots` are increasing places on the only axis, or their number: they are then distributed as
    the axis's `scale` says, the ends included. With several axes `knots` is a number for all, or a
    sequence with places or a number for each: the knots are those of a tensor grid. The values at
    them are called c0, c1 …; for several axes c00, c01 …, the last axis first. The form is constant
    before the first and after the last knot. It is linear in the coefficients, and has no divisor.
    Raises ValueError for knots that are not increasing or are outside the domain, for less than
    two, and for another number of axes.
    """
    axes = reference.axes if axes is None else axes
    places = [
        _places(name, each, axis)
        for each, axis in zip(_of_axes(name, knots, axes), axes, strict=True)
    ]
    taken = [text for axis in axes for text in (axis.name, axis.symbol)]
    letter = free_letter("c", taken)
    shape = [len(each) for each in places]
    names = [coefficient_name(letter, each) for each in np.ndindex(*shape)]

    def value(c, *point) -> Any:
        # The ramps of an axis are computed once, and used for every row of the grid.
        ramps = [_ramps(*each) for each in zip(point, places, axes, strict=True)]
        return jnp.asarray(_interpolated([c[k] for k in range(len(names))], ramps))

    equation = equation_of(reference.symbol, *_text(names, places, axes, taken))
    return Form(name, equation, reference, axes, names, (Stage(value),))


def _of_axes(name: str, knots: Any, axes: tuple[Axis, ...]) -> list:
    """Return the knots of each axis, or their number."""
    if len(axes) == 1:
        return [knots]
    given = [knots] * len(axes) if isinstance(knots, int | np.integer) else list(knots)
    if len(given) != len(axes):
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(f"{name}: {len(given)} knots: allowed are one number, or those of {names}")
    return given


def _ramps(at: Any, places: list[float], axis: Axis) -> list[Any]:
    """Return a ramp from 0 to 1 for each piece of an axis.

    Outside its piece it is exactly 0 or 1, so that an interval bound of the sum is no wider than
    that of one piece.
    """
    found = []
    for left, right in itertools.pairwise(places):
        ramp = (at - left) * (1 / (right - left))
        if left > axis.lower:
            ramp = jnp.maximum(ramp, 0.0)
        if right < axis.upper:
            ramp = jnp.minimum(ramp, 1.0)
        found.append(ramp)
    return found


def _interpolated(values: list[Any], ramps: list[list[Any]]) -> Any:
    """Interpolate along the first axis between values that are interpolated along the others."""
    if not ramps:
        return values[0]
    size = len(values) // (len(ramps[0]) + 1)
    rows = [_interpolated(values[k : k + size], ramps[1:]) for k in range(0, len(values), size)]
    total = rows[0]
    for ramp, (before, after) in zip(ramps[0], itertools.pairwise(rows), strict=True):
        total = total + (after - before) * ramp
    return total


def _text(
    names: list[str], places: list[list[float]], axes: tuple[Axis, ...], taken: list[str]
) -> tuple[str, list[str]]:
    """Return the form as text, and the statements before it: a ramp, and rows of the grid."""
    v = free_variable(taken)
    statements, row = [f"ramp({v}) = min(max({v}, 0), 1)"], free_letter("r", taken)
    values = names
    for depth in range(len(axes) - 1, 0, -1):
        size, shape = len(places[depth]), [len(each) for each in places[:depth]]
        rows = [coefficient_name(row, each) for each in np.ndindex(*shape)]
        for k, left in enumerate(rows):
            text = _line(values[size * k : size * (k + 1)], places[depth], axes[depth])
            statements.append(f"{left} = {text}")
        values = rows
    return _line(values, places[0], axes[0]), statements


def _line(values: Sequence[str], places: list[float], axis: Axis) -> str:
    parts = [
        f"({after} − {before})·ramp({_difference(axis.symbol, left)}/{number_text(right - left)})"
        for (before, after), (left, right) in zip(
            itertools.pairwise(values), itertools.pairwise(places), strict=True
        )
    ]
    return " + ".join([values[0], *parts])


def _difference(symbol: str, left: float) -> str:
    sign = "−" if left > 0 else "+"
    return f"({symbol} {sign} {number_text(abs(left))})" if left else symbol


def _places(name: str, knots: Any, axis: Axis) -> list[float]:
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
