"""Starts of quotients of linear functions."""

import numpy as np
import pytest

from fitting.points.grids import sobol_points
from fitting.solvers.residuals import residuals
from fitting.solvers.starts import quotient_starts
from tests.fitting.toys import AXES, PLANE, QUOTIENT, toy_form

POINTS = sobol_points(AXES, 8, seed=6)
X, Y = POINTS.T


def problem(form, exact, scale=None):
    weights = np.ones(len(exact)) if scale is None else scale
    free, fixed = np.full(form.size, True), np.zeros(form.size)
    return residuals(form, POINTS, exact, weights, free, fixed)


def test_an_exact_quotient_is_found_by_two_of_the_methods():
    c = np.array([1.0, 0.5, -0.2, 2.0, 0.3])
    exact = (c[0] + c[1] * X + c[2] * Y) / (1 + c[3] * X + c[4] * Y * Y)
    linearised, programmed, polynomial = quotient_starts(problem(QUOTIENT, exact))
    np.testing.assert_allclose(linearised, c, rtol=1e-10)
    # The linear program is solved to 1e-10 at best.
    np.testing.assert_allclose(programmed, c, rtol=1e-6)
    np.testing.assert_array_equal(polynomial[3:], 0)


@pytest.mark.parametrize("size", [1e-6, 1e6])
def test_the_scale_of_the_terms_does_not_matter(size):
    def call(c, x, y):
        return (c[0] + c[1] * x * size) / (1 + c[2] * y * y * size)

    exact = (2 + 3 * X) / (1 + 0.5 * Y * Y)
    starts = quotient_starts(problem(toy_form(call, ["1", "x", "y²"]), exact))
    for start in starts[:2]:
        np.testing.assert_allclose(start * [1, size, size], [2, 3, 0.5], rtol=1e-6)


def test_denominators_are_positive_where_the_linear_problem_has_a_pole():
    exact = 1 / (0.3 + Y - X)
    form = toy_form(lambda c, x, y: c[0] / (1 + c[1] * (y - 0.5) + c[2] * x), ["a", "y", "x"])
    starts = quotient_starts(problem(form, exact))
    assert starts
    for start in starts:
        assert np.min(1 + start[1] * (Y - 0.5) + start[2] * X) > 0


def test_a_linear_form_has_its_least_squares_fit():
    exact, scale = np.exp(X) + Y, 1 + X
    (start,) = quotient_starts(problem(PLANE, exact, scale))
    matrix = np.column_stack([np.ones(len(X)), X, Y])
    expected = np.linalg.lstsq(matrix * scale[:, None], exact * scale, rcond=None)[0]
    np.testing.assert_allclose(start, expected, rtol=1e-10)


def test_other_forms_have_none():
    form = toy_form(lambda c, x, y: c[0] * c[1] * x, ["a", "b"])
    assert quotient_starts(problem(form, X)) == []
