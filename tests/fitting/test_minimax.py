import numpy as np
import pytest

from fitting import Goal, improve
from fitting.paper import QuadraticQ, RationalG
from fitting.points.sample import sample_of
from fitting.solvers.minimax import ROOM, lower_bound, minimise_largest, residuals

NODES = np.linspace(0, 0.5, 501)[:, None]
ONES = np.ones(len(NODES))


def problem(exact: np.ndarray, fixed=(np.nan, np.nan), bounded: bool = False):
    return residuals(QuadraticQ, NODES, exact, ONES, np.array(fixed), bounded)


def test_the_error_of_the_best_parabola_alternates():
    # 1 + c₀d + c₁d² for 1 + d³ on [0, ½].
    exact = 1 + NODES[:, 0] ** 3
    found = minimise_largest(problem(exact), np.array([0.3, -0.2]))
    error = problem(exact).values(found)
    largest = np.abs(error).max()
    # Two coefficients, and no error at d = 0: three extrema of one size with changing signs.
    alternating = np.sign(error[np.abs(error) > 0.999 * largest])
    assert np.count_nonzero(np.diff(alternating)) == 2
    # Any other parabola is worse.
    for step in ([1e-3, 0], [-1e-3, 0], [0, 1e-3], [0, -1e-3], [1e-3, -2e-3]):
        assert np.abs(problem(exact).values(found + np.array(step))).max() > largest


def test_the_bound_of_a_linear_form_is_attained():
    exact = np.exp(-2 * NODES[:, 0])
    found = minimise_largest(problem(exact), np.zeros(2))
    largest = float(np.abs(problem(exact).values(found)).max())
    bound = lower_bound(QuadraticQ, NODES, exact, problem(exact).values(found))
    assert bound is not None
    assert 0.99 * largest < bound <= largest * (1 + 1e-9)


@pytest.mark.parametrize(("side", "sign"), [("below", 1), ("above", -1)])
def test_a_side_is_kept_at_every_point(side, sign):
    exact = np.exp(-2 * NODES[:, 0])
    both = np.abs(problem(exact).values(minimise_largest(problem(exact), np.zeros(2)))).max()
    error = problem(exact).values(minimise_largest(problem(exact), np.zeros(2), side))
    assert (sign * error).max() <= 3e-6  # the programs are solved to 1e-7
    assert both < np.abs(error).max() < 10 * both


def test_bounded_values_stay_away_from_zero_and_one():
    # The parabola that follows this best falls below 0.
    exact = np.exp(-20 * NODES[:, 0])
    free, bounded = (problem(exact, bounded=each) for each in (False, True))
    outside, inside = (minimise_largest(each, np.array([-0.1, 0.0])) for each in (free, bounded))
    assert np.min(exact + free.values(outside)) < -0.05
    values = exact + bounded.values(inside)
    # No nearer than ROOM, or half of what the exact value leaves; programs are solved to 1e-7.
    assert np.all(values >= np.minimum(ROOM, exact / 2) - 1e-6)
    assert np.all(1 - values >= np.minimum(ROOM, (1 - exact) / 2) - 1e-6)
    assert np.abs(free.values(outside)).max() < np.abs(bounded.values(inside)).max()
    # It is as near as it may be.
    assert values.min() < 2 * ROOM


def test_bounds_and_a_side_hold_together():
    exact = np.exp(-20 * NODES[:, 0])
    both = problem(exact, bounded=True)
    values = exact + both.values(minimise_largest(both, np.zeros(2), "above"))
    assert np.all(values >= exact - 1e-6)
    assert np.all(values <= 1 + 1e-6)


def test_a_fixed_coefficient_is_left_alone():
    exact = np.exp(-2 * NODES[:, 0])
    found = minimise_largest(problem(exact, (-2.0, np.nan)), np.zeros(1))
    whole = np.array([-2.0, found[0]])
    assert np.abs(problem(exact).values(whole)).max() == pytest.approx(
        np.abs(problem(exact, (-2.0, np.nan)).values(found)).max(), rel=1e-14
    )


def test_a_bound_says_when_the_error_is_not_the_least():
    exact = np.exp(-2 * NODES[:, 0])
    start = np.array([-1.5, 1.0])
    errors = problem(exact).values(start)
    bound = lower_bound(QuadraticQ, NODES, exact, errors)
    assert bound is None or bound < 0.6 * np.abs(errors).max()


def test_the_paper_s_forms_are_within_one_per_cent_of_the_least_largest_error():
    fit = improve(RationalG, Goal("linf"), start=np.array([2.0, 0.5, 1.0, 2.0]))
    assert fit.lower_bound is not None
    assert 0.99 * fit.on_grid.largest < fit.lower_bound <= fit.on_grid.largest * (1 + 1e-9)
    # Least squares leaves more.
    squares = improve(RationalG, Goal(), start=np.array([2.0, 0.5, 1.0, 2.0]))
    assert fit.off_grid.largest < 0.9 * squares.off_grid.largest
    assert fit.off_grid.rms > squares.off_grid.rms
    assert squares.lower_bound is None


@pytest.mark.slow
def test_no_program_steps_over_a_pole():
    sample = sample_of(RationalG)
    start = np.array([2.0, 0.5, 1.0, 2.0])
    free = residuals(
        RationalG, sample.points, sample.exact, np.ones(len(sample.exact)), np.full(4, np.nan)
    )
    found = minimise_largest(free, start)
    assert np.isfinite(free.values(found)).all()
    assert np.abs(free.values(found)).max() < np.abs(free.values(start)).max()
