"""Lower bounds of the largest error of a form, whatever its coefficients are."""

from dataclasses import replace

import numpy as np
import pytest

from fitting import Goal
from fitting.fit import fit
from fitting.proofs.least_error import LEVELS, _raised, least_error
from fitting.solvers.minimax import Minimax
from fitting.solvers.residuals import residuals
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G
from tests.fitting.toys import toy_form

NODES = np.linspace(0, 0.5, 501)[:, None]
EXACT = np.exp(-2 * NODES[:, 0])
Q_PROBLEM = residuals(QUADRATIC_Q, NODES, EXACT, np.ones(501), np.array([True, True]), np.zeros(2))


def test_the_bound_of_a_linear_form_is_nearly_attained():
    best = Minimax()(Q_PROBLEM, np.zeros(2))
    largest = float(np.abs(Q_PROBLEM.values(best)).max())
    bound = least_error(QUADRATIC_Q.fitted(best), NODES, EXACT)
    assert bound is not None
    assert 0.9999 * largest < bound <= largest
    # The exact values' own error may be in the form's favour.
    assert least_error(QUADRATIC_Q.fitted(best), NODES, EXACT, 1e-5) == pytest.approx(bound - 1e-5)
    assert least_error(QUADRATIC_Q.fitted(best), NODES, EXACT, 1.0) is None


@pytest.mark.parametrize("size", [1e-3, 1e-9])
def test_the_bound_of_a_small_error_is_as_tight(size):
    """HiGHS solves to 1e-7 at best 1e-10: errors are divided by the largest one."""
    exact = 1 - 2 * NODES[:, 0] + size * np.cos(40 * NODES[:, 0])
    problem = residuals(QUADRATIC_Q, NODES, exact, np.ones(501), np.full(2, True), np.zeros(2))
    best = Minimax()(problem, np.array([-2.0, 0.0]))
    largest = float(np.abs(problem.values(best)).max())
    bound = least_error(QUADRATIC_Q.fitted(best), NODES, exact)
    assert largest < 2 * size
    assert bound is not None and 0.999 * largest < bound <= largest


def test_the_bound_shows_that_an_error_is_not_the_least():
    worse = np.array([-1.5, 1.0])
    bound = least_error(QUADRATIC_Q.fitted(worse), NODES, EXACT)
    assert bound is None or bound < 0.6 * np.abs(Q_PROBLEM.values(worse)).max()


def test_no_coefficients_have_a_smaller_error_than_the_bound():
    best = Minimax()(Q_PROBLEM, np.zeros(2))
    bound = least_error(QUADRATIC_Q.fitted(best), NODES, EXACT)
    assert bound is not None
    random = np.random.default_rng(3)
    for size in (1e-1, 1e-3, 1e-5):
        for step in random.normal(size=(200, 2)):
            assert np.abs(Q_PROBLEM.values(best + size * step)).max() >= bound


def test_where_no_bound_is_sought_there_is_none():
    """A form that says so, one without coefficients, and one that is no quotient."""
    silent = replace(QUADRATIC_Q, has_least_error=False).fitted(np.array([-1.7, 1.2]))
    assert least_error(silent, NODES, EXACT) is None
    points = np.array([[0.1, 0.2], [0.3, 0.4]])
    for form, coefficients in (
        (toy_form(lambda c, x, y: x + y, []), np.zeros(0)),
        (toy_form(lambda c, x, y: c[0] * c[1] * x, ["a", "b"]), np.ones(2)),
    ):
        assert least_error(form.fitted(coefficients), points, np.ones(2)) is None


def test_a_refuted_level_is_raised_to_within_a_sixteenth_of_the_next_one():
    tried = []

    def is_refuted(level):
        tried.append(level)
        return level < 0.937

    assert 0.937 - 0.05 / 16 <= _raised(0.9, 0.95, is_refuted) < 0.937
    assert all(0.9 < level < 0.95 for level in tried)
    tried.clear()
    assert _raised(0.9, 0.9, is_refuted) == 0.9 and not tried


def test_bounds_are_sought_from_the_tightest():
    assert list(LEVELS) == sorted(LEVELS, reverse=True)
    assert max(LEVELS) < 1


@pytest.mark.slow
def test_the_form_of_g_in_print_is_within_one_per_cent_of_the_least_largest_error():
    form = replace(RATIONAL_G, starts=(np.array([2.0, 0.5, 1.0, 2.0]),))
    found = fit(form, Goal("linf"))
    assert found.least_error is not None
    assert 0.99 * found.on_grid.largest < found.least_error
    assert found.least_error <= found.on_grid.largest * (1 + 1e-9)
    # Least squares leaves more.
    squares = fit(form, Goal())
    assert found.off_grid.largest < 0.9 * squares.off_grid.largest
    assert found.off_grid.rms > squares.off_grid.rms
    assert squares.least_error is None
