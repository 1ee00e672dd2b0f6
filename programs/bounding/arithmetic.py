"""Interval arithmetic: bounds of sums, products and functions of intervals, rounded outwards.

A result that is known to be exact is not rounded, so that √(1 − x²) on [0, 1] is seen to be
defined: a sum of floating-point numbers that rounds to zero is zero, the sign of a product is that
of its factors, and the square of one is one. Where an operation is undefined on a part of an
interval, its bounds are infinite or NaN.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

# NumPy's elementary functions have errors of at most 4 units in the last place.
_ELEMENTARY_ULPS = 4
# A place of an extreme value that is this near an end of an interval, in units of π or relative to
# the end, is counted as inside: rounding may have moved it.
_NEAR, _RELATIVELY_NEAR = 1e-12, 1e-15


class Interval(NamedTuple):
    """Lower and upper bounds, one of each for every box."""

    lower: np.ndarray
    upper: np.ndarray


Image = Callable[[Interval], Interval]


def outward(lower: np.ndarray, upper: np.ndarray, ulps: int = 1) -> Interval:
    """Move bounds (…) outwards by `ulps` units in the last place."""
    for _ in range(ulps):
        lower, upper = np.nextafter(lower, -np.inf), np.nextafter(upper, np.inf)
    return Interval(lower, upper)


def add(a: Interval, b: Interval) -> Interval:
    """Bound a + b."""
    return _sum(a.lower + b.lower, a.upper + b.upper)


def subtract(a: Interval, b: Interval) -> Interval:
    """Bound a − b."""
    return _sum(a.lower - b.upper, a.upper - b.lower)


def _sum(lower: np.ndarray, upper: np.ndarray) -> Interval:
    # Sums do not underflow: one that rounds to zero is zero.
    bounds = outward(lower, upper)
    return Interval(
        np.where(lower == 0, 0.0, bounds.lower), np.where(upper == 0, 0.0, bounds.upper)
    )


def multiply(a: Interval, b: Interval) -> Interval:
    """Bound a·b."""
    products = (a.lower * b.lower, a.lower * b.upper, a.upper * b.lower, a.upper * b.upper)
    bounds = outward(np.minimum.reduce(products), np.maximum.reduce(products))
    zero = _is_zero(a) | _is_zero(b)
    alike = _not_negative(a) & _not_negative(b) | _not_positive(a) & _not_positive(b) | zero
    unlike = _not_negative(a) & _not_positive(b) | _not_positive(a) & _not_negative(b) | zero
    # np.maximum keeps the NaN of 0·∞.
    return Interval(
        np.where(alike, np.maximum(bounds.lower, 0), bounds.lower),
        np.where(unlike, np.minimum(bounds.upper, 0), bounds.upper),
    )


def _not_negative(a: Interval) -> np.ndarray:
    return a.lower >= 0


def _not_positive(a: Interval) -> np.ndarray:
    return a.upper <= 0


def _is_zero(a: Interval) -> np.ndarray:
    return _not_negative(a) & _not_positive(a)


def square(a: Interval) -> Interval:
    """Bound a²."""
    magnitudes = absolute(a)
    bounds = outward(magnitudes.lower**2, magnitudes.upper**2)
    lower, upper = np.maximum(bounds.lower, 0), bounds.upper
    return Interval(
        np.where(magnitudes.lower == 1, 1.0, lower), np.where(magnitudes.upper == 1, 1.0, upper)
    )


def reciprocal(a: Interval) -> Interval:
    """Bound 1/a. The bounds are infinite if a may be zero."""
    straddles = (a.lower <= 0) & (a.upper >= 0)
    lower, upper = outward(1 / a.upper, 1 / a.lower)
    return Interval(np.where(straddles, -np.inf, lower), np.where(straddles, np.inf, upper))


def divide(a: Interval, b: Interval) -> Interval:
    """Bound a/b."""
    return multiply(a, reciprocal(b))


def negate(a: Interval) -> Interval:
    """Bound −a."""
    return Interval(-a.upper, -a.lower)


def hull(a: Interval, b: Interval) -> Interval:
    """Bound what is in a or in b."""
    return Interval(np.minimum(a.lower, b.lower), np.maximum(a.upper, b.upper))


def maximum(a: Interval, b: Interval) -> Interval:
    """Bound the larger one. A lower bound of one operand serves even if the other is NaN."""
    return Interval(np.fmax(a.lower, b.lower), np.maximum(a.upper, b.upper))


def minimum(a: Interval, b: Interval) -> Interval:
    """Bound the smaller one."""
    return Interval(np.minimum(a.lower, b.lower), np.minimum(a.upper, b.upper))


def absolute(a: Interval) -> Interval:
    """Bound |a|."""
    low, high = np.abs(a.lower), np.abs(a.upper)
    least = np.where((a.lower <= 0) & (a.upper >= 0), 0.0, np.minimum(low, high))
    return Interval(least, np.maximum(low, high))


def _rising(function: Callable) -> Image:
    return lambda a: outward(function(a.lower), function(a.upper), _ELEMENTARY_ULPS)


def _limited(image: Image, lower: float, upper: float) -> Image:
    """Cut bounds to the range of a function."""

    def apply(a: Interval) -> Interval:
        bounds = image(a)
        return Interval(np.maximum(bounds.lower, lower), np.minimum(bounds.upper, upper))

    return apply


exp = _limited(_rising(np.exp), 0.0, np.inf)
exp2 = _limited(_rising(np.exp2), 0.0, np.inf)
expm1 = _limited(_rising(np.expm1), -1.0, np.inf)
log = _rising(np.log)
log1p = _rising(np.log1p)
sinh = _rising(np.sinh)
tanh = _limited(_rising(np.tanh), -1.0, 1.0)
atan = _rising(np.arctan)


def sqrt(a: Interval) -> Interval:
    """Bound √a. The part of a below zero is left out: it has no root."""
    bounds = _rising(np.sqrt)(Interval(np.maximum(a.lower, 0), np.maximum(a.upper, 0)))
    return Interval(np.maximum(bounds.lower, 0), bounds.upper)


def cosh(a: Interval) -> Interval:
    """Bound cosh a, which rises with |a|."""
    bounds = _rising(np.cosh)(absolute(a))
    return Interval(np.maximum(bounds.lower, 1), bounds.upper)


def asin(a: Interval) -> Interval:
    """Bound arcsin a. The part of a outside [−1, 1] is left out."""
    return _rising(np.arcsin)(Interval(np.maximum(a.lower, -1), np.minimum(a.upper, 1)))


def acos(a: Interval) -> Interval:
    """Bound arccos a, which falls. The part of a outside [−1, 1] is left out."""
    low, high = np.maximum(a.lower, -1), np.minimum(a.upper, 1)
    return outward(np.arccos(high), np.arccos(low), _ELEMENTARY_ULPS)


def _multiples_of_pi(a: Interval, offset: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and the last whole number k with (k + offset)·π in a, or near its ends."""
    low, high = a.lower / np.pi - offset, a.upper / np.pi - offset
    room = np.maximum(_NEAR, _RELATIVELY_NEAR * np.maximum(np.abs(low), np.abs(high)))
    return np.ceil(low - room), np.floor(high + room)


def cos(a: Interval) -> Interval:
    """Bound cos a."""
    ends = np.cos(a.lower), np.cos(a.upper)
    lower, upper = outward(np.minimum(*ends), np.maximum(*ends), _ELEMENTARY_ULPS)
    # The cosine has a maximum at each even multiple of π and a minimum at each odd one.
    first, last = _multiples_of_pi(a, 0.0)
    has_even = (last - first >= 1) | ((last == first) & (first % 2 == 0))
    has_odd = (last - first >= 1) | ((last == first) & (first % 2 != 0))
    return Interval(
        np.where(has_odd, -1.0, np.maximum(lower, -1)),
        np.where(has_even, 1.0, np.minimum(upper, 1)),
    )


def sin(a: Interval) -> Interval:
    """Bound sin a."""
    return cos(outward(a.lower - np.pi / 2, a.upper - np.pi / 2, _ELEMENTARY_ULPS))


def tan(a: Interval) -> Interval:
    """Bound tan a. The bounds are infinite if a may be an odd multiple of π/2."""
    bounds = _rising(np.tan)(a)
    first, last = _multiples_of_pi(a, 0.5)
    has_pole = ~(last < first)
    return Interval(
        np.where(has_pole, -np.inf, bounds.lower), np.where(has_pole, np.inf, bounds.upper)
    )


def floor(a: Interval) -> Interval:
    """Bound ⌊a⌋, exactly."""
    return Interval(np.floor(a.lower), np.floor(a.upper))


def ceil(a: Interval) -> Interval:
    """Bound ⌈a⌉, exactly."""
    return Interval(np.ceil(a.lower), np.ceil(a.upper))


def atan2(y: Interval, x: Interval) -> Interval:
    """Bound the angle of (x, y). The bounds are ±π if it may jump there, or be undefined."""
    right, up, down = x.lower > 0, y.lower > 0, y.upper < 0
    whole = Interval(np.full_like(right, -np.pi, float), np.full_like(right, np.pi, float))
    half = Interval(whole.upper / 2, whole.upper / 2)
    above = subtract(half, atan(divide(x, y)))
    angle = _choose(up, above, subtract(negate(half), atan(divide(x, y))))
    angle = _choose(right, atan(divide(y, x)), angle)
    return outward(*_choose(right | up | down, angle, whole), _ELEMENTARY_ULPS)


def _choose(condition: np.ndarray, a: Interval, b: Interval) -> Interval:
    return Interval(np.where(condition, a.lower, b.lower), np.where(condition, a.upper, b.upper))
