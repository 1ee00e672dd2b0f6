"""Enclosures compared with exact arithmetic: every sampled value and slope must lie inside."""

import itertools

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from programs.bounding import arithmetic as iv
from programs.bounding import interval
from programs.functions import Function, Parameter
from programs.program import Program
from programs.tracing.tracer import trace

INPUTS = 2


def program_of(call) -> Program:
    parameters = tuple(Parameter(name, (-1.0, 1.0)) for name in "xy")
    return trace(Function("Example", "An example.", parameters, None, "value", call))


Step = type(program_of(lambda x, y: x + y).steps[0])


class Jet:
    """A number of 40 digits with its gradient; it shares no code with the enclosures."""

    def __init__(self, value, gradient=(0, 0)):
        self.value, self.gradient = mpmath.mpf(value), [mpmath.mpf(g) for g in gradient]

    def chain(self, value, slope):
        return Jet(value, [slope * g for g in self.gradient])


def _product(a, b):
    slopes = [a.value * h + b.value * g for g, h in zip(a.gradient, b.gradient, strict=True)]
    return Jet(a.value * b.value, slopes)


def _sum(sign):
    def combine(a, b):
        slopes = [g + sign * h for g, h in zip(a.gradient, b.gradient, strict=True)]
        return Jet(a.value + sign * b.value, slopes)

    return combine


def _inverse(a):
    return a.chain(1 / a.value, -1 / a.value**2)


def _root(a):
    root = mpmath.sqrt(a.value)
    return a.chain(root, 1 / (2 * root))


def _angle(y, x):
    squares = x.value**2 + y.value**2
    slopes = [
        (x.value * h - y.value * g) / squares for g, h in zip(x.gradient, y.gradient, strict=True)
    ]
    return Jet(mpmath.atan2(y.value, x.value), slopes)


def _power(a, b):
    if a.value <= 0:  # the slope is infinite or undefined
        raise ZeroDivisionError
    log = a.chain(mpmath.log(a.value), 1 / a.value)
    exponent = _product(b, log)
    return exponent.chain(mpmath.exp(exponent.value), mpmath.exp(exponent.value))


EXACT = {
    "add": _sum(1),
    "sub": _sum(-1),
    "mul": _product,
    "div": lambda a, b: _product(a, _inverse(b)),
    "neg": lambda a: a.chain(-a.value, -1),
    "sqrt": _root,
    "exp": lambda a: a.chain(mpmath.exp(a.value), mpmath.exp(a.value)),
    "log": lambda a: a.chain(mpmath.log(a.value), 1 / a.value),
    "cos": lambda a: a.chain(mpmath.cos(a.value), -mpmath.sin(a.value)),
    "sin": lambda a: a.chain(mpmath.sin(a.value), mpmath.cos(a.value)),
    "max": lambda a, b: a if a.value >= b.value else b,
    "min": lambda a, b: a if a.value <= b.value else b,
    # At 0 it is not differentiable: the quotient raises ZeroDivisionError.
    "abs": lambda a: a.chain(abs(a.value), mpmath.mpf(a.value) / abs(mpmath.mpf(a.value))),
    "rsqrt": lambda a: _inverse(_root(a)),
    "exp2": lambda a: a.chain(mpmath.mpf(2) ** a.value, mpmath.mpf(2) ** a.value * mpmath.log(2)),
    "expm1": lambda a: a.chain(mpmath.expm1(a.value), mpmath.exp(a.value)),
    "log1p": lambda a: a.chain(mpmath.log1p(a.value), 1 / (1 + a.value)),
    "tan": lambda a: a.chain(mpmath.tan(a.value), mpmath.sec(a.value) ** 2),
    "asin": lambda a: a.chain(mpmath.asin(a.value), 1 / mpmath.sqrt(1 - a.value**2)),
    "acos": lambda a: a.chain(mpmath.acos(a.value), -1 / mpmath.sqrt(1 - a.value**2)),
    "atan": lambda a: a.chain(mpmath.atan(a.value), 1 / (1 + a.value**2)),
    "sinh": lambda a: a.chain(mpmath.sinh(a.value), mpmath.cosh(a.value)),
    "cosh": lambda a: a.chain(mpmath.cosh(a.value), mpmath.sinh(a.value)),
    "tanh": lambda a: a.chain(mpmath.tanh(a.value), mpmath.sech(a.value) ** 2),
    "floor": lambda a: a.chain(mpmath.floor(a.value), 0),
    "ceil": lambda a: a.chain(mpmath.ceil(a.value), 0),
    "atan2": _angle,
    "pow": _power,
    "gt": lambda a, b: a.value > b.value,
    "select": lambda condition, a, b: a if condition else b,
}


def exactly(program: Program, point) -> Jet | None:
    """Evaluate a program at a point; None if it is not defined or not differentiable there."""
    unit = np.eye(INPUTS)
    try:
        with mpmath.workdps(40):
            inputs = [Jet(x, row) for x, row in zip(point, unit, strict=True)]
            (jet,) = interval.interpret(program, inputs, EXACT, Jet)
    except (ZeroDivisionError, TypeError, OverflowError):  # TypeError: a complex root compared
        return None
    if any(isinstance(x, mpmath.mpc) for x in (jet.value, *jet.gradient)):
        return None
    return jet


def enclosures(program: Program, lower, upper):
    """Return the interval of the value, as `enclose` does, and that of the gradient."""
    lower, upper = np.atleast_2d(lower).astype(float), np.atleast_2d(upper).astype(float)
    (value,) = interval.enclose(program, lower, upper)
    inputs = [interval._variable(k, lower, upper) for k in range(INPUTS)]
    with np.errstate(all="ignore"):
        (natural,) = interval.interpret(
            program, inputs, interval._OPERATIONS, lambda c: interval._constant(c, lower)
        )
    return value, natural.gradient


def inside(number, bounds, *index) -> bool:
    """Return whether an exact number lies in an interval; a bound that is NaN is no bound."""
    lower, upper = bounds.lower[index], bounds.upper[index]
    above = np.isnan(lower) or mpmath.mpf(float(lower)) <= number
    return bool(above and (np.isnan(upper) or number <= mpmath.mpf(float(upper))))


UNARY = (
    *("neg", "sqrt", "exp", "log", "cos", "sin", "square", "abs", "rsqrt", "exp2", "expm1"),
    *("log1p", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "floor", "ceil"),
)
BINARY = ("add", "sub", "mul", "div", "max", "min", "choose", "pow", "atan2")
NUMBERS = st.sampled_from([-2.0, -0.7, 0.1, 0.5, 1.0, 3.0])
POSITIONS = st.integers(0, 20)
# An operation; its operands, as positions counted from the latest value, or a constant; a factor
RECIPES = st.lists(
    st.tuples(st.sampled_from(UNARY), POSITIONS, st.none(), st.none() | NUMBERS)
    | st.tuples(st.sampled_from(BINARY), POSITIONS, POSITIONS | NUMBERS, st.none() | NUMBERS),
    min_size=1,
    max_size=8,
)


def built(recipe) -> Program:
    """Make a straight-line program of two inputs from a recipe."""
    steps, values = [], list(range(INPUTS))

    def add(operation, *operands):
        steps.append(Step(operation, operands))
        return INPUTS + len(steps) - 1

    for name, first, second, factor in recipe:
        one = values[-1 - first % len(values)]
        other = values[-1 - second % len(values)] if isinstance(second, int) else second
        if name == "square":
            value = add("mul", one, one)
        elif name == "choose":
            value = add("select", add("gt", one, other), one, other)
        else:
            value = add(name, one) if second is None else add(name, one, other)
        values.append(value if factor is None else add("mul", value, factor))
    return Program("Random", ("x", "y"), tuple(steps), (values[-1],))


@settings(max_examples=120, deadline=None)
@given(
    recipe=RECIPES,
    corner=st.tuples(*[st.floats(-4, 4)] * INPUTS),
    size=st.tuples(*[st.sampled_from([0.0, 1e-9, 0.03, 0.6, 5.0])] * INPUTS),
    places=st.lists(st.tuples(*[st.floats(0, 1)] * INPUTS), min_size=4, max_size=4),
)
def test_every_value_and_slope_on_a_box_lies_in_its_enclosure(recipe, corner, size, places):
    program = built(recipe)
    lower = np.array(corner)
    upper = lower + size
    ends = [np.where(at, upper, lower) for at in itertools.product((False, True), repeat=INPUTS)]
    inner = [np.clip(lower + np.array(p) * (upper - lower), lower, upper) for p in places]
    jets = [exactly(program, point) for point in (*ends, *inner)]
    # If the expression has no value on a part of the box, any enclosure is right.
    assume(all(jet is not None for jet in jets))
    value, gradient = enclosures(program, lower, upper)
    for jet in jets:
        assert inside(jet.value, value, 0)
        for k in range(INPUTS):
            assert inside(jet.gradient[k], gradient, k, 0)


TIGHT = {
    # expression, lower and upper corner of the box, exact range
    "sum": (lambda x, y: x + y, (0, 1), (2, 3), (1.0, 5.0)),
    "square": (lambda x, y: x * x, (-1, 0), (2, 1), (0.0, 4.0)),
    "reciprocal": (lambda x, y: 1 / x, (2, 0), (4, 1), (0.25, 0.5)),
    "negative reciprocal": (lambda x, y: 1 / x, (-4, 0), (-2, 1), (-0.5, -0.25)),
    "maximum of cosine": (lambda x, y: jnp.cos(x), (-0.5, 0), (1.0, 1), (np.cos(1.0), 1.0)),
    "minimum of cosine": (lambda x, y: jnp.cos(x), (3, 0), (3.5, 1), (-1.0, np.cos(3.5))),
    "sine about its maximum": (lambda x, y: jnp.sin(x), (1, 0), (2.5, 1), (np.sin(2.5), 1.0)),
    "cosine over a period": (lambda x, y: jnp.cos(x), (0.1, 0), (7, 1), (-1.0, 1.0)),
    "cosine far out": (lambda x, y: jnp.cos(x), (1e9, 0), (1e9 + 7, 1), (-1.0, 1.0)),
    "root at zero": (lambda x, y: jnp.sqrt(x), (0, 0), (4, 1), (0.0, 2.0)),
    "exponential": (lambda x, y: jnp.exp(-x), (0, 0), (1, 1), (np.exp(-1), 1.0)),
    "logarithm": (lambda x, y: jnp.log(x), (1, 0), (2, 1), (0.0, np.log(2))),
    "either branch": (lambda x, y: jnp.where(x > y, 3.0, x), (0, 0), (1, 1), (0.0, 3.0)),
    "monotone by its slope": (lambda x, y: x - x * x / 4, (0, 0), (0.01, 1), (0.0, 0.009975)),
}


@pytest.mark.parametrize("name", TIGHT)
def test_simple_ranges_are_enclosed_tightly(name):
    call, lower, upper, (low, high) = TIGHT[name]
    value, _ = enclosures(program_of(call), lower, upper)
    width = 1e-14 if name != "monotone by its slope" else 5e-5
    assert low - width <= value.lower[0] <= low + 1e-300
    assert high - 1e-300 <= value.upper[0] <= high + width


UNBOUNDED = {
    "pole inside": lambda x, y: 1 / x,
    "pole at an end": lambda x, y: 1 / (x + 1),
    "logarithm of zero": lambda x, y: jnp.log(x + 1),
    "pole of a product": lambda x, y: (y - y) * (1 / x),
}


@pytest.mark.parametrize("name", UNBOUNDED)
def test_a_pole_has_no_bound(name):
    value, _ = enclosures(program_of(UNBOUNDED[name]), (-1, -1), (1, 1))
    assert not np.isfinite(value.lower[0])


def test_smaller_boxes_have_tighter_bounds():
    def bowl(x, y):
        return (x - 0.3) ** 2 + (y + 0.2) ** 2 + x * y * (1 + x)

    program = program_of(bowl)
    lines = np.linspace(-1, 1, 2001)
    exact = bowl(*np.meshgrid(lines, lines)).min()
    gaps = []
    for parts in (8, 32, 128):
        ends = np.linspace(-1, 1, parts + 1)
        lower = np.array(list(itertools.product(ends[:-1], repeat=2)))
        value, _ = enclosures(program, lower, lower + 2 / parts)
        gaps.append(exact - value.lower.min())
    # The error of the mean value form is proportional to the square of the side.
    assert gaps[0] > 10 * gaps[1] > 100 * gaps[2] > 0


def test_boxes_enclosed_together_have_the_same_bounds_as_alone():
    program = program_of(lambda x, y: jnp.exp(x) / (2 + y))
    lower = np.array([[0.0, 0.0], [-1.0, 1.0], [2.0, -1.5]])
    together, slopes = enclosures(program, lower, lower + 0.5)
    for box in range(3):
        alone, slope = enclosures(program, lower[box], lower[box] + 0.5)
        assert (together.lower[box], together.upper[box]) == (alone.lower[0], alone.upper[0])
        np.testing.assert_array_equal(slopes.lower[:, box], slope.lower[:, 0])


def test_an_operation_without_an_interval_version_is_refused_by_name():
    program = Program("Random", ("x", "y"), (Step("gamma", (0,)),), (2,))
    with pytest.raises(ValueError, match="'gamma'"):
        interval.enclose(program, np.zeros((1, 2)), np.ones((1, 2)))


def test_a_tangent_is_unbounded_exactly_on_boxes_with_a_pole():
    lower = np.array([-1.0, 1.0, 2.0, -2.0, 4.0, 4.8, 11.1, -4.6])
    upper = np.array([1.0, 2.0, 4.0, -1.0, 5.0, 7.8, 13.9, -1.7])
    found = iv.tan(iv.Interval(lower, upper))
    poles = [False, True, False, True, True, False, False, False]
    assert np.isinf(found.lower).tolist() == np.isinf(found.upper).tolist() == poles
    inside = ~np.array(poles)
    assert (found.lower <= np.tan(lower))[inside].all()
    assert (found.upper >= np.tan(upper))[inside].all()


def test_an_arc_cosine_leaves_out_what_is_outside_its_domain():
    found = iv.acos(iv.Interval(np.array([0.5, -3.0]), np.array([1.5, 0.0])))
    np.testing.assert_allclose(found.lower, [0.0, np.pi / 2], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(found.upper, [np.pi / 3, np.pi], rtol=1e-12)
