"""Sums of exponentials of one axis."""

import functools
import math
from typing import Any

import jax.numpy as jnp
import numpy as np

from fitting.equation import equation_of
from fitting.form import Form, Stage
from fitting.shapes.monomial_sums import free_letter
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
) -> Form:
    """Return the form Σ aₖ exp(−bₖ x), plus a constant c0 if `constant` is true.

    It has one axis, and 1 ≤ k ≤ `terms`. If `monotone`, the squares of all coefficients are taken
    in their place: whatever they are, the form is then never negative and never rises. A fit starts
    from rates bₖ that are evenly spaced in the logarithm over the axis's width (over 1 if that is
    infinite). Raises ValueError for more than one axis, and for less than one term.
    """
    axes = reference.axes if axes is None else axes
    axis = only_axis(name, axes)
    if terms < 1:
        raise ValueError(f"{name}: terms = {terms}: at least 1 is needed")
    taken = [axis.name, axis.symbol]
    a = free_letter("a", taken)
    b, c0 = free_letter("b", [*taken, f"{a}1"]), free_letter("c", [*taken, f"{a}1"])
    names = [f"{letter}{k}" for k in range(1, terms + 1) for letter in (a, b)]
    first = [f"{c0}0"] if constant else []
    two = "²" if monotone else ""
    parts = [f"{a}{k}{two}·exp(−{b}{k}{two}·{axis.symbol})" for k in range(1, terms + 1)]
    text = " + ".join([*(f"{each}{two}" for each in first), *parts])

    def value(c, x) -> Any:
        at = len(first)
        c = [c[k] * c[k] if monotone else c[k] for k in range(at + 2 * terms)]
        parts = [c[at + 2 * k] * jnp.exp(-c[at + 2 * k + 1] * x) for k in range(terms)]
        return functools.reduce(jnp.add, [*([c[0]] if constant else []), *parts])

    starts = tuple(_start(axis, terms, constant, *ends) for ends in _RATES)
    if monotone:
        # The derivative by c0 would be zero at c0 = 0.
        starts = tuple(np.sqrt(np.maximum(start, _LEAST)) for start in starts)
    equation = equation_of(reference.symbol, text)
    return Form(name, equation, reference, axes, [*first, *names], (Stage(value),), starts=starts)


def only_axis(name: str, axes: tuple[Axis, ...]) -> Axis:
    """Return the only axis. Raises ValueError if there are several."""
    if len(axes) != 1:
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(f"{name} has the axes {names}: allowed is one axis")
    return axes[0]


def _start(axis: Axis, terms: int, constant: bool, slow: float, fast: float) -> np.ndarray:
    width = axis.upper - axis.lower
    width = width if math.isfinite(width) else 1.0
    rates = np.geomspace(slow, fast, terms) if terms > 1 else np.sqrt([slow * fast])
    # At the lower end, the terms add up to 1.
    sizes = np.exp(np.minimum(rates / width * axis.lower, _LARGEST_EXPONENT)) / terms
    pairs = np.stack([sizes, rates / width], axis=1).ravel()
    return np.concatenate([[0.0], pairs]) if constant else pairs
