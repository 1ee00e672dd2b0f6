"""Lower bounds of the largest error of a form, whatever its coefficients are."""

from dataclasses import replace

import numpy as np

from fitting import Goal
from fitting.fit import fit
from fitting.proofs.least_error import LEVELS, least_error
from fitting.solvers.minimax import Minimax
from fitting.solvers.residuals import residuals
from quantities import problem
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G
from tests.fitting.toys import toy_form

NODES = np.linspace(0, 0.5, 501)[:, None]
EXACT = np.exp(-2 * NODES[:, 0])
Q_PROBLEM = residuals(QUADRATIC_Q, NODES, EXACT, np.ones(501), np.array([True, True]), np.zeros(2))


def test_the_bound_of_a_linear_form_is_nearly_attained():
    errors = Q_PROBLEM.values(Minimax()(Q_PROBLEM, np.zeros(2)))
    largest = float(np.abs(errors).max())
    bound = least_error(QUADRATIC_Q, NODES, EXACT, errors)
    assert bound is not None
    assert 0.99 * largest < bound <= largest * (1 + 1e-9)


def test_the_bound_shows_that_an_error_is_not_the_least():
    errors = Q_PROBLEM.values(np.array([-1.5, 1.0]))
    bound = least_error(QUADRATIC_Q, NODES, EXACT, errors)
    assert bound is None or bound < 0.6 * np.abs(errors).max()


def test_no_coefficients_have_a_smaller_error_than_the_bound():
    best = Minimax()(Q_PROBLEM, np.zeros(2))
    bound = least_error(QUADRATIC_Q, NODES, EXACT, Q_PROBLEM.values(best))
    assert bound is not None
    random = np.random.default_rng(3)
    for size in (1e-1, 1e-3, 1e-5):
        for step in random.normal(size=(200, 2)):
            assert np.abs(Q_PROBLEM.values(best + size * step)).max() >= bound


def test_where_no_bound_is_sought_there_is_none():
    """A form that says so, one without coefficients, and one that is no quotient."""
    errors = Q_PROBLEM.values(np.array([-1.7, 1.2]))
    silent = replace(QUADRATIC_Q, has_least_error=False)
    assert least_error(silent, NODES, EXACT, errors) is None
    assert (
        not problem("q")
        .find_form("pole-q", {"structure": "one", "terms": 2, "poles": 0})
        .has_least_error
    )
    points = np.array([[0.1, 0.2], [0.3, 0.4]])
    for form in (
        toy_form(lambda c, x, y: x + y, []),
        toy_form(lambda c, x, y: c[0] * c[1] * x, ["a", "b"]),
    ):
        assert least_error(form, points, np.ones(2), np.array([0.1, -0.2])) is None


def test_bounds_are_sought_from_the_tightest():
    assert list(LEVELS) == sorted(LEVELS, reverse=True)
    assert max(LEVELS) < 1


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
