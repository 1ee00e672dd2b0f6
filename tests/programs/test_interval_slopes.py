"""Enclosures of single operations: at points they are exact, and slopes end where they must."""

import numpy as np
import pytest

from programs.bounding import arithmetic as iv
from programs.bounding import interval
from programs.program import Program, Step
from tests.programs.test_interval import BINARY, built, enclosures, exactly, inside, program_of

# Points of operations of one and of two operands; slopes are tight where they have one
AT = {
    **dict.fromkeys(
        ("neg", "exp", "cos", "sin", "abs", "exp2", "expm1", "atan"), (-1.7, -0.5, 0.6)
    ),
    **dict.fromkeys(("sinh", "cosh", "tanh", "floor", "ceil"), (-2.3, -0.5, 0.6)),
    **dict.fromkeys(("sqrt", "log", "rsqrt"), (0.04, 0.7, 30.0)),
    **dict.fromkeys(("asin", "acos"), (-0.9, -0.1, 0.6)),
    **{"log1p": (-0.6, 0.3, 4.0), "tan": (-1.2, 0.3, 2.0)},
}
PAIRS = ((0.3, 2.0), (0.6, -1.5), (-0.7, 1.4), (-0.2, -0.9), (3.0, 0.1))


@pytest.mark.parametrize("operation", [*AT, "square", *BINARY])
def test_values_and_slopes_at_a_point_are_the_exact_ones(operation):
    if operation in BINARY or operation == "square":
        points = np.array([pair for pair in PAIRS if operation != "pow" or pair[0] > 0])
        second = None if operation == "square" else 0
        program = built([(operation, 1, second, None)])
    else:
        points = np.array([(x, 1.0) for x in AT[operation]])
        program = built([(operation, 1, None, None)])
    values, slopes = enclosures(program, points, points)
    for box, point in enumerate(points.tolist()):
        exact = exactly(program, point)
        for number, bounds, place in (
            (exact.value, values, (box,)),
            *((g, slopes, (k, box)) for k, g in enumerate(exact.gradient)),
        ):
            assert inside(number, bounds, *place)
            if operation in ("choose", "max", "min"):
                continue  # these have the slopes of both cases
            width = bounds.upper[place] - bounds.lower[place]
            assert width <= 2e-14 * max(abs(number), 0.5)


def slopes_of(operation: str, *sides: tuple[float, float]) -> list[tuple[float, float]]:
    """Return the bounds of both slopes of an operation on one box."""
    lower, upper = np.array([*sides, (0.0, 0.0)][:2]).T
    step = Step(operation, tuple(range(len(sides))))
    _, slopes = enclosures(Program("One", ("x", "y"), (step,), (2,)), lower, upper)
    return [(slopes.lower[k, 0], slopes.upper[k, 0]) for k in range(2)]


def test_the_slope_of_a_size_is_known_up_to_its_kink():
    sides = {(0.0, 0.4): (1, 1), (-0.4, -0.1): (-1, -1), (-0.1, 0.4): (-1, 1)}
    for side, expected in sides.items():
        np.testing.assert_allclose(slopes_of("abs", side)[0], expected, rtol=1e-15)
    low, high = slopes_of("abs", (0.0, 0.0))[0]
    assert low <= high


def test_a_step_has_no_slope_where_it_jumps():
    for operation in ("floor", "ceil"):
        assert slopes_of(operation, (0.2, 0.7))[0] == (0, 0)
        assert slopes_of(operation, (0.2, 1.2))[0] == (-np.inf, np.inf)


JUMPS = {
    # x and y of the box -> whether the angle jumps there, or has no value
    ((-2, -1), (-1, 1)): True,
    ((-2, -1), (0, 1)): True,
    ((-2, -1), (-1, 0)): True,
    ((0, 1), (0, 1)): True,
    ((-1, 0), (-1, 0.5)): True,
    ((-1, 1), (-0.5, 0.5)): True,
    ((0.5, 1), (-1, 1)): False,
    ((-1, 1), (0.5, 1)): False,
    ((-2, -1), (-1, -0.5)): False,
    ((-2, 2), (-3, -1.5)): False,
}


@pytest.mark.parametrize("box", JUMPS)
def test_an_angle_has_no_slope_where_it_jumps(box):
    x, y = box
    for slope in slopes_of("atan2", y, x):
        assert (slope == (-np.inf, np.inf)) == JUMPS[box]
        assert np.isfinite(slope).all() != JUMPS[box]


def test_the_mean_value_form_is_that_about_the_middle():
    # x² − 4x is −4 in the middle of [1, 3], and its slope is in [−2, 2]; y counts in the same way.
    program = program_of(lambda x, y: (x * x - 4 * x) + (y * y - 14 * y))
    value, slopes = enclosures(program, (1, 6), (3, 8))
    np.testing.assert_allclose(value, [[-4 - 49 - 4], [-4 - 49 + 4]], rtol=1e-14)
    np.testing.assert_allclose(slopes.lower[:, 0], [-2, -2], rtol=1e-14)
    np.testing.assert_allclose(slopes.upper[:, 0], [2, 2], rtol=1e-14)


def test_a_middle_that_is_rounded_to_an_end_is_allowed_for():
    high = np.nextafter(1, 2)
    value, _ = enclosures(program_of(lambda x, y: (x - 1) * 1e8), (1, 0), (high, 1))
    assert value.lower[0] <= 0 and value.upper[0] >= 1e8 * (high - 1)


def test_the_bounds_of_one_operation_on_intervals():
    one, two = (iv.Interval(np.array([low]), np.array([high])) for low, high in ((-1, 2), (3, 5)))
    assert interval.image_of("add", [one, two]) == iv.add(one, two)
    assert interval.image_of("mul", [one, one]) == iv.square(one)
    assert interval.image_of("mul", [one, two]) == iv.multiply(one, two)
    assert interval.image_of("select", [None, one, two]) == (-1, 5)
    assert interval.image_of("lt", [one, two]) is None
