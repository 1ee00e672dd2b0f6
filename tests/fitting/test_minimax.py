"""The least largest error by linear programs."""

import numpy as np
import pytest

from fitting.points.sample import sample_of
from fitting.shapes.piecewise import piecewise_linear
from fitting.solvers.minimax import Minimax
from fitting.solvers.residuals import badness, largest_of, limits, residuals
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G
from tests.fitting.toys import TOY

NODES = np.linspace(0, 0.5, 501)[:, None]
D = NODES[:, 0]
ONES = np.ones(len(NODES))
FREE = np.array([True, True])
# Bounded values keep this distance from 0 and 1, or half of what the exact value leaves.
ROOM = 1e-3
# The linear programs are solved to 1e-7.
SOLVED = 1e-6

minimise = Minimax()


def problem(exact: np.ndarray, free=FREE, fixed=(0.0, 0.0), bounded: bool = False):
    """Return the residuals of 1 + c₀d + c₁d² on [0, ½]."""
    return residuals(QUADRATIC_Q, NODES, exact, ONES, free, np.array(fixed), bounded)


def test_residuals_are_the_scaled_errors_and_their_slopes():
    exact, scale = np.exp(-2 * D), 1 + D
    found = residuals(QUADRATIC_Q, NODES, exact, scale, FREE, np.zeros(2))
    z = np.array([-1.5, 0.7])
    np.testing.assert_allclose(found.values(z), (1 - 1.5 * D + 0.7 * D**2 - exact) * scale)
    rows = np.array([3, 250])
    expected = np.stack([D, D**2], axis=1)[rows] * scale[rows, None]
    np.testing.assert_allclose(found.slopes(z, rows), expected, rtol=1e-14)


def test_the_error_of_the_best_parabola_alternates():
    # 1 + c₀d + c₁d² for 1 + d³ on [0, ½].
    exact = 1 + D**3
    found = minimise(problem(exact), np.array([0.3, -0.2]))
    error = problem(exact).values(found)
    largest = np.abs(error).max()
    # Two coefficients, and no error at d = 0: three extrema of one size with changing signs.
    alternating = np.sign(error[np.abs(error) > 0.999 * largest])
    assert np.count_nonzero(np.diff(alternating)) == 2
    # Any other parabola is worse.
    for step in ([1e-3, 0], [-1e-3, 0], [0, 1e-3], [0, -1e-3], [1e-3, -2e-3]):
        assert np.abs(problem(exact).values(found + np.array(step))).max() > largest


@pytest.mark.parametrize(("side", "sign"), [("below", 1), ("above", -1)])
def test_a_side_is_kept_at_every_point(side, sign):
    exact = np.exp(-2 * D)
    both = np.abs(problem(exact).values(minimise(problem(exact), np.zeros(2)))).max()
    error = problem(exact).values(minimise(problem(exact), np.zeros(2), side))
    assert (sign * error).max() <= 3 * SOLVED
    assert both < np.abs(error).max() < 10 * both


def test_bounded_values_stay_away_from_zero_and_one():
    # The parabola that follows this best falls below 0.
    exact = np.exp(-20 * D)
    free, bounded = (problem(exact, bounded=each) for each in (False, True))
    outside, inside = (minimise(each, np.array([-0.1, 0.0])) for each in (free, bounded))
    assert np.min(exact + free.values(outside)) < -0.05
    values = exact + bounded.values(inside)
    assert np.all(values >= np.minimum(ROOM, exact / 2) - SOLVED)
    assert np.all(1 - values >= np.minimum(ROOM, (1 - exact) / 2) - SOLVED)
    assert np.abs(free.values(outside)).max() < np.abs(bounded.values(inside)).max()
    # They come as near as they may.
    assert values.min() < 2 * ROOM


def test_bounds_and_a_side_hold_together():
    exact = np.exp(-20 * D)
    both = problem(exact, bounded=True)
    values = exact + both.values(minimise(both, np.zeros(2), "above"))
    assert np.all(values >= exact - SOLVED)
    assert np.all(values <= 1 + SOLVED)


def test_a_fixed_coefficient_is_left_alone():
    exact = np.exp(-2 * D)
    half = problem(exact, np.array([False, True]), (-2.0, 0.0))
    (found,) = minimise(half, np.zeros(1))
    np.testing.assert_allclose(
        problem(exact).values(np.array([-2.0, found])), half.values(np.array([found])), rtol=1e-14
    )
    np.testing.assert_array_equal(half.slopes(np.array([found]), np.array([7]))[0], [D[7] ** 2])


def test_a_form_without_coefficients_has_nothing_to_minimise():
    nothing = problem(np.exp(-2 * D), np.array([False, False]), (-2.0, 1.0))
    assert len(minimise(nothing, np.zeros(0))) == 0


def test_a_side_limits_the_errors_that_are_allowed():
    bounded = problem(np.full(501, 0.25), bounded=True)
    for side, low, high in (
        ("both", -0.249, 0.749),
        ("below", -0.249, 0.0),
        ("above", 0.0, 0.749),
    ):
        least, most = limits(bounded, side)
        np.testing.assert_allclose([least[0], most[0]], [low, high], rtol=1e-14)
    least, most = limits(problem(np.full(501, 0.25)), "both")
    assert (least[0], most[0]) == (-np.inf, np.inf)


def test_an_error_that_is_not_allowed_is_worse_than_any_that_is():
    error = np.array([-0.5, 0.0, 1e-3, 0.4, np.nan])
    bad = badness(error, np.full(5, -np.inf), np.zeros(5))
    assert bad[2] > 50 and bad[3] > bad[2] > bad[0] > bad[1] == 0
    assert bad[4] == np.inf


def test_the_largest_sizes_are_chosen():
    sizes = np.array([0.1, 5.0, 3.0, 4.0])
    np.testing.assert_array_equal(largest_of(sizes, 2), [False, True, False, True])
    assert largest_of(sizes, 9).all()


@pytest.mark.slow
def test_no_program_steps_over_a_pole():
    sample = sample_of(RATIONAL_G)
    start = np.array([2.0, 0.5, 1.0, 2.0])
    free = residuals(
        RATIONAL_G,
        sample.points,
        sample.exact,
        np.ones(len(sample.exact)),
        np.full(4, True),
        np.zeros(4),
    )
    found = minimise(free, start)
    assert np.isfinite(free.values(found)).all()
    assert np.abs(free.values(found)).max() < np.abs(free.values(start)).max()


def test_a_coefficient_that_changes_no_value_at_the_points_is_no_obstacle():
    """No point is between the last knots of x. Before, the steps of such values were infinite."""
    form = piecewise_linear(TOY, (9, 9), name="knots")
    points = np.random.default_rng(0).random((60, 2)) * (0.4, 3) - (0, 1)
    ones, free = np.ones(len(points)), np.full(form.size, True)
    found = residuals(form, points, np.asarray(TOY.values(points)), ones, free, 0.0 * free)
    start = np.full(form.size, 2.0)
    assert np.abs(found.values(start)).max() > 1
    assert np.abs(found.values(minimise(found, start))).max() < 0.01
