"""Interval arithmetic with first derivatives: bounds that hold on a whole box, not only at samples.

An `Enclosure` holds, for many boxes at once, an interval that contains all values of an expression
on the box, and one interval for each partial derivative. Every bound is rounded outwards.
"""

from typing import NamedTuple

import numpy as np

from programs.program import Program, interpret

# NumPy's elementary functions have errors of at most 4 units in the last place.
_ELEMENTARY_ULPS = 4


class Interval(NamedTuple):
    """Lower and upper bounds, one of each for every box."""

    lower: np.ndarray
    upper: np.ndarray


class Enclosure(NamedTuple):
    """Intervals of the value (boxes,) and of the gradient (inputs, boxes) of an expression."""

    value: Interval
    gradient: Interval


def enclose(program: Program, lower: np.ndarray, upper: np.ndarray) -> list[Interval]:
    """Bound each output of a program on boxes with corners `lower` and `upper` (boxes, inputs).

    The result is the intersection of two enclosures: the natural interval extension and the mean
    value form. Raises ValueError for an operation that has no interval version.
    """
    return [each.value for each in enclose_with_slopes(program, lower, upper)]


def enclose_with_slopes(program: Program, lower: np.ndarray, upper: np.ndarray) -> list[Enclosure]:
    """Return the bounds of `enclose` together with bounds of the gradient on each box."""
    inputs = [_variable(k, lower, upper) for k in range(lower.shape[1])]
    middle = (lower + upper) / 2
    centre = [Interval(x, x) for x in middle.T]
    with np.errstate(all="ignore"):
        natural = interpret(program, inputs, _OPERATIONS, lambda c: _constant(c, lower))
        central = interpret(program, centre, _VALUES, lambda c: _number(c, lower))
        offsets = [_sub(whole.value, x) for whole, x in zip(inputs, centre, strict=True)]
        return [
            Enclosure(_mean_value(n, c, offsets), n.gradient)
            for n, c in zip(natural, central, strict=True)
        ]


def _mean_value(natural: Enclosure, central: Interval, offsets: list[Interval]) -> Interval:
    total = central
    for k, offset in enumerate(offsets):
        slope = Interval(natural.gradient.lower[k], natural.gradient.upper[k])
        total = _add(total, _mul(slope, offset))
    lower, upper = natural.value
    # An unbounded slope gives 0·∞ = NaN, which fmax and fmin ignore: the natural bounds remain.
    return Interval(np.fmax(lower, total.lower), np.fmin(upper, total.upper))


def _variable(index: int, lower: np.ndarray, upper: np.ndarray) -> Enclosure:
    slope = np.zeros((lower.shape[1], lower.shape[0]))
    slope[index] = 1
    return Enclosure(Interval(lower[:, index], upper[:, index]), Interval(slope, slope))


def _number(value: float, like: np.ndarray) -> Interval:
    number = np.full(len(like), float(value))
    return Interval(number, number)


def _constant(value: float, like: np.ndarray) -> Enclosure:
    slope = np.zeros((like.shape[1], len(like)))
    return Enclosure(_number(value, like), Interval(slope, slope))


def _outward(lower: np.ndarray, upper: np.ndarray, ulps: int = 1) -> Interval:
    for _ in range(ulps):
        lower, upper = np.nextafter(lower, -np.inf), np.nextafter(upper, np.inf)
    return Interval(lower, upper)


def _add(a: Interval, b: Interval) -> Interval:
    return _outward(a.lower + b.lower, a.upper + b.upper)


def _sub(a: Interval, b: Interval) -> Interval:
    return _outward(a.lower - b.upper, a.upper - b.lower)


def _mul(a: Interval, b: Interval) -> Interval:
    products = (a.lower * b.lower, a.lower * b.upper, a.upper * b.lower, a.upper * b.upper)
    return _outward(np.minimum.reduce(products), np.maximum.reduce(products))


def _square(a: Interval) -> Interval:
    low, high = np.abs(a.lower), np.abs(a.upper)
    least = np.where((a.lower <= 0) & (a.upper >= 0), 0.0, np.minimum(low, high))
    bounds = _outward(least**2, np.maximum(low, high) ** 2)
    return Interval(np.maximum(bounds.lower, 0), bounds.upper)


def _reciprocal(a: Interval) -> Interval:
    straddles = (a.lower <= 0) & (a.upper >= 0)
    lower, upper = _outward(1 / a.upper, 1 / a.lower)
    return Interval(np.where(straddles, -np.inf, lower), np.where(straddles, np.inf, upper))


def _neg(a: Interval) -> Interval:
    return Interval(-a.upper, -a.lower)


def _hull(a: Interval, b: Interval) -> Interval:
    return Interval(np.minimum(a.lower, b.lower), np.maximum(a.upper, b.upper))


def _rising(function):
    def image(a: Interval) -> Interval:
        return _outward(function(a.lower), function(a.upper), _ELEMENTARY_ULPS)

    return image


_EXP, _LOG = _rising(np.exp), _rising(np.log)


def _sqrt(a: Interval) -> Interval:
    bounds = _rising(np.sqrt)(Interval(np.maximum(a.lower, 0), np.maximum(a.upper, 0)))
    return Interval(np.maximum(bounds.lower, 0), bounds.upper)


def _cos(a: Interval) -> Interval:
    ends = np.cos(a.lower), np.cos(a.upper)
    lower, upper = _outward(np.minimum(*ends), np.maximum(*ends), _ELEMENTARY_ULPS)
    # The cosine has a maximum at each even multiple of π and a minimum at each odd one. The margin
    # also counts multiples that rounding may have put just outside the interval.
    first = np.ceil(a.lower / np.pi - 1e-12)
    last = np.floor(a.upper / np.pi + 1e-12)
    has_even = (last - first >= 1) | ((last == first) & (first % 2 == 0))
    has_odd = (last - first >= 1) | ((last == first) & (first % 2 != 0))
    return Interval(
        np.where(has_odd, -1.0, np.maximum(lower, -1)),
        np.where(has_even, 1.0, np.minimum(upper, 1)),
    )


def _sin(a: Interval) -> Interval:
    shifted = _outward(a.lower - np.pi / 2, a.upper - np.pi / 2, _ELEMENTARY_ULPS)
    return _cos(shifted)


def _linear(combine):
    return lambda a, b: Enclosure(combine(a.value, b.value), combine(a.gradient, b.gradient))


def _product(a: Enclosure, b: Enclosure) -> Enclosure:
    if a is b:
        twice = _add(a.value, a.value)
        return Enclosure(_square(a.value), _mul(twice, a.gradient))
    slope = _add(_mul(a.value, b.gradient), _mul(b.value, a.gradient))
    return Enclosure(_mul(a.value, b.value), slope)


def _unary(image, slope):
    """Make the enclosure of a function from its image and its slope(argument, image)."""

    def apply(a: Enclosure) -> Enclosure:
        value = image(a.value)
        return Enclosure(value, _mul(slope(a.value, value), a.gradient))

    return apply


_inverse = _unary(_reciprocal, lambda _, y: _neg(_square(y)))


def _quotient(a: Enclosure, b: Enclosure) -> Enclosure:
    return _product(a, _inverse(b))


def _max(a: Interval, b: Interval) -> Interval:
    # A lower bound of one operand bounds the maximum, even if the other has no bound (NaN).
    return Interval(np.fmax(a.lower, b.lower), np.maximum(a.upper, b.upper))


def _min(a: Interval, b: Interval) -> Interval:
    return Interval(np.minimum(a.lower, b.lower), np.minimum(a.upper, b.upper))


def _either(image):
    """Make the enclosure of an operation that returns one of its two operands."""
    return lambda a, b: Enclosure(image(a.value, b.value), _hull(a.gradient, b.gradient))


def _undecided(*_) -> None:
    """Do not evaluate a condition: a selection is enclosed by the hull of both its cases."""


_CONDITIONS = dict.fromkeys(("lt", "le", "gt", "ge", "eq", "ne", "and", "or", "not"), _undecided)
_OPERATIONS = {
    "add": _linear(_add),
    "sub": _linear(_sub),
    "mul": _product,
    "div": _quotient,
    "neg": lambda a: Enclosure(_neg(a.value), _neg(a.gradient)),
    "sqrt": _unary(_sqrt, lambda _, y: _reciprocal(_add(y, y))),
    "exp": _unary(_EXP, lambda _, y: y),
    "log": _unary(_LOG, lambda x, _: _reciprocal(x)),
    "cos": _unary(_cos, lambda x, _: _neg(_sin(x))),
    "sin": _unary(_sin, lambda x, _: _cos(x)),
    "max": _either(_max),
    "min": _either(_min),
    "select": lambda _, a, b: _either(_hull)(a, b),
    **_CONDITIONS,
}
# The same operations on values only, for the centre of the mean value form
_VALUES = {
    "add": _add,
    "sub": _sub,
    "mul": lambda a, b: _square(a) if a is b else _mul(a, b),
    "div": lambda a, b: _mul(a, _reciprocal(b)),
    "neg": _neg,
    "sqrt": _sqrt,
    "exp": _EXP,
    "log": _LOG,
    "cos": _cos,
    "sin": _sin,
    "max": _max,
    "min": _min,
    "select": lambda _, a, b: _hull(a, b),
    **_CONDITIONS,
}
