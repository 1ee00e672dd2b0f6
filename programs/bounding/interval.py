"""Interval arithmetic with first derivatives: bounds that hold on a whole box, not only at samples.

An `Enclosure` holds, for many boxes at once, an interval that contains all values of an expression
on the box, and one interval for each partial derivative. Every bound is rounded outwards.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from programs.bounding import arithmetic as iv
from programs.bounding.arithmetic import Interval
from programs.program import Program, interpret


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
    """Return the bounds of `enclose` together with bounds of the gradient on each box.

    `lower` and `upper` (boxes, inputs) are the corners of the boxes.
    """
    inputs = [_variable(k, lower, upper) for k in range(lower.shape[1])]
    middle = (lower + upper) / 2
    centre = [Interval(x, x) for x in middle.T]
    with np.errstate(all="ignore"):
        natural = interpret(program, inputs, _OPERATIONS, lambda c: _constant(c, lower))
        central = interpret(program, centre, _VALUES, lambda c: _number(c, lower))
        offsets = [iv.subtract(whole.value, x) for whole, x in zip(inputs, centre, strict=True)]
        return [
            Enclosure(_mean_value(n, c, offsets), n.gradient)
            for n, c in zip(natural, central, strict=True)
        ]


def image_of(operation: str, operands: list[Interval | None]) -> Interval | None:
    """Bound the result of one operation on intervals; None for a condition, which has no bounds."""
    with np.errstate(all="ignore"):
        return _VALUES[operation](*operands)


def _mean_value(natural: Enclosure, central: Interval, offsets: list[Interval]) -> Interval:
    total = central
    for k, offset in enumerate(offsets):
        slope = Interval(natural.gradient.lower[k], natural.gradient.upper[k])
        total = iv.add(total, iv.multiply(slope, offset))
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


def _linear(combine):
    return lambda a, b: Enclosure(combine(a.value, b.value), combine(a.gradient, b.gradient))


def _product(a: Enclosure, b: Enclosure) -> Enclosure:
    if a is b:
        twice = iv.add(a.value, a.value)
        return Enclosure(iv.square(a.value), iv.multiply(twice, a.gradient))
    slope = iv.add(iv.multiply(a.value, b.gradient), iv.multiply(b.value, a.gradient))
    return Enclosure(iv.multiply(a.value, b.value), slope)


def _unary(image, slope):
    """Make the enclosure of a function from its image and its slope(argument, image)."""

    def apply(a: Enclosure) -> Enclosure:
        value = image(a.value)
        return Enclosure(value, iv.multiply(slope(a.value, value), a.gradient))

    return apply


def _reciprocal_root(x: Interval) -> Interval:
    return iv.reciprocal(iv.sqrt(x))


def _plus_one(a: Interval) -> Interval:
    return iv.add(a, _like(a, 1.0))


def _like(a: Interval, value: float) -> Interval:
    return Interval(np.full_like(a.lower, value), np.full_like(a.lower, value))


def _sign(a: Interval, _) -> Interval:
    return Interval(np.where(a.lower >= 0, 1.0, -1.0), np.where(a.upper < 0, -1.0, 1.0))


def _step(_, y: Interval) -> Interval:
    """Return the slope of a step function: 0 where it is constant, and no bound where it jumps."""
    jump = np.where(y.lower == y.upper, 0.0, np.inf)
    return Interval(-jump, jump)


def _root_slope(sign: float):
    """Return the slope ±1/√(1 − x²) of arcsin and arccos."""

    def slope(x: Interval, _) -> Interval:
        root = iv.sqrt(iv.subtract(_like(x, 1.0), iv.square(x)))
        return iv.multiply(_like(x, sign), iv.reciprocal(root))

    return slope


_inverse = _unary(iv.reciprocal, lambda _, y: iv.negate(iv.square(y)))
_exp = _unary(iv.exp, lambda _, y: y)
_log = _unary(iv.log, lambda x, _: iv.reciprocal(x))


def _quotient(a: Enclosure, b: Enclosure) -> Enclosure:
    return _product(a, _inverse(b))


def _angle(y: Enclosure, x: Enclosure) -> Enclosure:
    """Return the enclosure of atan2; the slope has no bound where the angle may jump."""
    value = iv.atan2(y.value, x.value)
    squares = iv.add(iv.square(x.value), iv.square(y.value))
    turn = iv.subtract(iv.multiply(x.value, y.gradient), iv.multiply(y.value, x.gradient))
    slope = iv.divide(turn, squares)
    jumps = (x.value.lower <= 0) & (y.value.lower <= 0) & (y.value.upper >= 0)
    return Enclosure(
        value,
        Interval(np.where(jumps, -np.inf, slope.lower), np.where(jumps, np.inf, slope.upper)),
    )


def _either(image):
    """Make the enclosure of an operation that returns one of its two operands."""
    return lambda a, b: Enclosure(image(a.value, b.value), iv.hull(a.gradient, b.gradient))


def _undecided(*_) -> None:
    """Do not evaluate a condition: a selection is enclosed by the hull of both its cases."""


_CONDITIONS = dict.fromkeys(("lt", "le", "gt", "ge", "eq", "ne", "and", "or", "not"), _undecided)
_LN2 = np.log(2)
# operation -> image of an interval, and slope(argument, image)
_FUNCTIONS = {
    "abs": (iv.absolute, _sign),
    "sqrt": (iv.sqrt, lambda _, y: iv.reciprocal(iv.add(y, y))),
    "rsqrt": (
        _reciprocal_root,
        lambda x, y: iv.multiply(_like(x, -0.5), iv.multiply(y, iv.reciprocal(x))),
    ),
    "exp": (iv.exp, lambda _, y: y),
    "exp2": (iv.exp2, lambda _, y: iv.multiply(y, iv.outward(*_like(y, _LN2)))),
    "expm1": (iv.expm1, lambda x, _: iv.exp(x)),
    "log": (iv.log, lambda x, _: iv.reciprocal(x)),
    "log1p": (iv.log1p, lambda x, _: iv.reciprocal(_plus_one(x))),
    "cos": (iv.cos, lambda x, _: iv.negate(iv.sin(x))),
    "sin": (iv.sin, lambda x, _: iv.cos(x)),
    "tan": (iv.tan, lambda _, y: _plus_one(iv.square(y))),
    "asin": (iv.asin, _root_slope(1.0)),
    "acos": (iv.acos, _root_slope(-1.0)),
    "atan": (iv.atan, lambda x, _: iv.reciprocal(_plus_one(iv.square(x)))),
    "sinh": (iv.sinh, lambda x, _: iv.cosh(x)),
    "cosh": (iv.cosh, lambda x, _: iv.sinh(x)),
    "tanh": (iv.tanh, lambda _, y: iv.subtract(_like(y, 1.0), iv.square(y))),
    "floor": (iv.floor, _step),
    "ceil": (iv.ceil, _step),
}
_OPERATIONS = {
    "add": _linear(iv.add),
    "sub": _linear(iv.subtract),
    "mul": _product,
    "div": _quotient,
    "neg": lambda a: Enclosure(iv.negate(a.value), iv.negate(a.gradient)),
    "max": _either(iv.maximum),
    "min": _either(iv.minimum),
    "pow": lambda a, b: _exp(_product(b, _log(a))),
    "atan2": _angle,
    "select": lambda _, a, b: _either(iv.hull)(a, b),
    **{name: _unary(*parts) for name, parts in _FUNCTIONS.items()},
    **_CONDITIONS,
}
# The same operations on values only, for the centre of the mean value form
_VALUES: dict[str, Callable[..., Any]] = {
    "add": iv.add,
    "sub": iv.subtract,
    "mul": lambda a, b: iv.square(a) if a is b else iv.multiply(a, b),
    "div": iv.divide,
    "neg": iv.negate,
    "max": iv.maximum,
    "min": iv.minimum,
    "pow": lambda a, b: iv.exp(iv.multiply(b, iv.log(a))),
    "atan2": iv.atan2,
    "select": lambda _, a, b: iv.hull(a, b),
    **{name: image for name, (image, _) in _FUNCTIONS.items()},
    **_CONDITIONS,
}
