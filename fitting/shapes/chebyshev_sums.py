"""Sums of Chebyshev polynomials of the axes, by Clenshaw's recurrence."""

import math
from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp

from fitting.equation import equation_of, free_variable
from fitting.form import Form, Stage
from fitting.shapes.monomial_sums import coefficient_name, free_letter
from integrals.reference import Axis, Reference
from programs.printing.formula import number_text


def chebyshev(
    reference: Reference,
    degrees: int | Sequence[int],
    *,
    name: str,
    axes: tuple[Axis, ...] | None = None,
) -> Form:
    """Return the form Σ cᵢⱼ Tᵢ(t₁) Tⱼ(t₂), with all products of Chebyshev polynomials.

    t maps an axis linearly to [−1, 1]. `degrees` are the degrees in the axes, or one number for
    all. The coefficients are called c0, c1 …; for several axes c00, c01 …, the last axis first.
    Raises ValueError for degrees that do not fit the axes, and for an axis without a finite end.
    """
    axes = reference.axes if axes is None else axes
    wanted = [degrees] * len(axes) if isinstance(degrees, int) else list(degrees)
    if len(wanted) != len(axes) or any(type(d) is not int or d < 0 for d in wanted):
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(f"{name}: degrees = {degrees}: allowed are whole numbers ≥ 0 for {names}")
    for axis in axes:
        require_finite(name, axis)
    shape = [d + 1 for d in wanted]
    letter = free_letter("c", [text for axis in axes for text in (axis.name, axis.symbol)])
    indices = _indices(shape)
    names = [coefficient_name(letter, each) for each in indices]
    maps = [_map(axis) for axis in axes]

    def value(c, *point) -> Any:
        t = [scale * x + offset for x, (scale, offset) in zip(point, maps, strict=True)]
        return jnp.asarray(_clenshaw([c[k] for k in range(len(names))], shape, t))

    taken = {text for axis in axes for text in (axis.name, axis.symbol)}
    t = next(each for each in "tuswz" if each not in taken)
    symbols = [t if len(axes) == 1 else f"{t}{k + 1}" for k in range(len(axes))]
    equation = _equation(reference.symbol, axes, indices, names, symbols)
    return Form(name, equation, reference, axes, names, (Stage(value),))


def require_finite(name: str, axis: Axis) -> None:
    """Raise ValueError if an axis has no finite end."""
    if not math.isfinite(axis.upper - axis.lower):
        raise ValueError(
            f"{name}: {axis.name} in {axis.domain}: allowed is a finite domain; restrict the axes"
        )


def _map(axis: Axis) -> tuple[float, float]:
    """Return the scale and the offset that map an axis to [−1, 1]."""
    width = axis.upper - axis.lower
    return 2 / width, -(axis.upper + axis.lower) / width


def _indices(shape: Sequence[int]) -> list[tuple[int, ...]]:
    found: list[tuple[int, ...]] = [()]
    for count in shape:
        found = [(*each, k) for each in found for k in range(count)]
    return found


def _clenshaw(c: list[Any], shape: Sequence[int], t: Sequence[Any]) -> Any:
    """Sum over the first axis, with sums over the other axes as its coefficients."""
    if not shape:
        return c[0]
    size = len(c) // shape[0]
    rows = [_clenshaw(c[k * size : (k + 1) * size], shape[1:], t[1:]) for k in range(shape[0])]
    if len(rows) == 1:
        return rows[0]
    # b_k = c_k + 2t b_{k+1} − b_{k+2}, and the sum is c_0 + t b_1 − b_2.
    double, after, last = 2 * t[0], None, rows[-1]
    for row in rows[-2:0:-1]:
        following = row + double * last
        last, after = following if after is None else following - after, last
    total = rows[0] + t[0] * last
    return total if after is None else total - after


def _equation(
    symbol: str,
    axes: Sequence[Axis],
    indices: list[tuple[int, ...]],
    names: list[str],
    symbols: Sequence[str],
) -> str:
    terms = [
        "·".join([name, *(_factor(k, s) for k, s in zip(each, symbols, strict=True) if k)])
        for each, name in zip(indices, names, strict=True)
    ]
    maps = [f"{s} = {_map_text(axis)}" for s, axis in zip(symbols, axes, strict=True)]
    x = free_variable([text for axis in axes for text in (axis.name, axis.symbol)])
    polynomials = [
        f"T{k}({x}) = 2·{x}·{_factor(k - 1, x)} − {_factor(k - 2, x)}"
        for k in range(2, max(max(each) for each in indices) + 1)
    ]
    return equation_of(symbol, " + ".join(terms), [*polynomials, *maps])


def _factor(degree: int, x: str) -> str:
    """Write a Chebyshev polynomial of x as a factor."""
    return ("1", x)[degree] if degree < 2 else f"T{degree}({x})"


def _map_text(axis: Axis) -> str:
    middle, width = axis.lower + axis.upper, axis.upper - axis.lower
    above = f"2·{axis.symbol}" + (
        "" if middle == 0 else f" {'−+'[middle < 0]} {number_text(abs(middle))}"
    )
    return above if width == 1 else f"({above})/{number_text(width)}"
