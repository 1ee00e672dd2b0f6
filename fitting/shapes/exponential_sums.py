"""Sums of exponentials of one axis, whose coefficients may depend on other axes."""

import functools
import math
from typing import Any

import jax.numpy as jnp
import numpy as np

from fitting.equation import equation_of
from fitting.form import Form, Stage
from fitting.shapes.monomial_sums import (
    coefficient_name,
    free_letter,
    monomials,
    nested_horner,
    sum_text,
)
from integrals.reference import Axis, Reference

# The rates of the starts go from the first to the last of these over the axis's width.
_RATES = ((0.5, 30.0), (0.2, 8.0), (1.0, 200.0))
# A start's amplitude is at most e to this.
_LARGEST_EXPONENT = 50.0
# The least square of a coefficient in the start of a monotone form.
_LEAST = 1e-2


def exponentials(
    reference: Reference,
    terms: int,
    *,
    name: str,
    axes: tuple[Axis, ...] | None = None,
    constant: bool = False,
    monotone: bool = False,
    along: str = "",
    degree: int = 0,
) -> Form:
    """Return the form Σ aₖ exp(−bₖ x), plus a constant c0 if `constant` is true.

    1 ≤ k ≤ `terms`. With several axes, x is the axis called `along`, by default the first one. The
    aₖ, the bₖ and the constant are then polynomials of the other axes, of this total `degree`. If
    `monotone`, the squares of all coefficients are taken in their place: whatever they are, the
    form is then never negative and never rises. A fit starts from rates bₖ that are evenly spaced
    in the logarithm over the axis's width (over 1 if that is infinite). Raises ValueError for less
    than one term, for an axis that is not known, and for several axes if `monotone`.
    """
    axes = reference.axes if axes is None else axes
    at = _place(name, axes, along, monotone)
    axis, others = axes[at], [each.symbol for k, each in enumerate(axes) if k != at]
    if terms < 1 or degree < 0:
        raise ValueError(f"{name}: terms = {terms}, degree {degree}: at least 1 and 0 are needed")
    if degree and not others:
        raise ValueError(f"{name}: degree = {degree}: there is no axis but {axis.name}")
    taken = [text for each in axes for text in (each.name, each.symbol)]
    a = free_letter("a", taken)
    b, c0 = free_letter("b", [*taken, f"{a}1"]), free_letter("c", [*taken, f"{a}1"])
    first = [f"{c0}0"] if constant else []
    parts = [*first, *(f"{letter}{k}" for k in range(1, terms + 1) for letter in (a, b))]
    powers = monomials(degree, len(others), total=True)
    names = [
        coefficient_name(f"{part}_", each) if degree else part for part in parts for each in powers
    ]
    size, two = len(powers), "²" if monotone else ""

    def value(c, *point) -> Any:
        c = [c[k] * c[k] if monotone else c[k] for k in range(len(names))]
        z = [x for k, x in enumerate(point) if k != at]
        parts = [
            nested_horner(dict(zip(powers, c[k : k + size], strict=True)), z)
            for k in range(0, len(c), size)
        ]
        pairs = zip(parts[len(first) :: 2], parts[len(first) + 1 :: 2], strict=True)
        terms = [amplitude * jnp.exp(-rate * point[at]) for amplitude, rate in pairs]
        return functools.reduce(jnp.add, [*parts[: len(first)], *terms])

    sums = [
        f"{part} = {sum_text(dict(zip(powers, names[size * k :], strict=False)), others)}"
        for k, part in enumerate(parts if degree else [])
    ]
    written = [f"{a}{k}{two}·exp(−{b}{k}{two}·{axis.symbol})" for k in range(1, terms + 1)]
    text = " + ".join([*(f"{each}{two}" for each in first), *written])
    equation = equation_of(reference.symbol, text, sums)
    starts = tuple(_start(axis, terms, constant, *ends) for ends in _RATES)
    if monotone:
        # The derivative by c0 would be zero at c0 = 0.
        starts = tuple(np.sqrt(np.maximum(start, _LEAST)) for start in starts)
    if degree:
        # The polynomials are constants at first.
        starts = tuple(np.kron(start, np.eye(1, size)[0]) for start in starts)
    return Form(name, equation, reference, axes, names, (Stage(value),), starts=starts)


def _place(name: str, axes: tuple[Axis, ...], along: str, monotone: bool) -> int:
    names = [axis.name for axis in axes]
    if along and along not in names:
        raise ValueError(f"{name}: along = {along!r}: allowed are {', '.join(names)}")
    if monotone and len(axes) > 1:
        raise ValueError(f"{name} has the axes {', '.join(names)}: monotone allows one axis")
    return names.index(along) if along else 0


def _start(axis: Axis, terms: int, constant: bool, slow: float, fast: float) -> np.ndarray:
    width = axis.upper - axis.lower
    width = width if math.isfinite(width) else 1.0
    rates = np.geomspace(slow, fast, terms) if terms > 1 else np.sqrt([slow * fast])
    # At the lower end, the terms add up to 1.
    sizes = np.exp(np.minimum(rates / width * axis.lower, _LARGEST_EXPONENT)) / terms
    pairs = np.stack([sizes, rates / width], axis=1).ravel()
    return np.concatenate([[0.0], pairs]) if constant else pairs
