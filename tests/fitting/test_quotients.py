"""Quotients of known features: the shape, and its least squares fits."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting import form_values
from fitting.points.grids import trapezoid_grid
from fitting.shapes.quotients import Quotients
from fitting.solvers import quotients
from fitting.solvers.least_squares import solve_nonlinear_jaxopt
from fitting.solvers.quotients import (
    DENOMINATOR_FLOOR,
    fit_quotient_on_grid,
    fit_quotients,
    penalty_points,
)
from quantities.fuzz.supplement import R_QUOTIENT, RATIONAL_R
from tests.fitting.minima import misfit, possible_gain, replace_solver, worst_of
from tests.fitting.toys import AXES

# The shape


def features(x, y):
    return jnp.stack([x, y, x * y])


ONE = Quotients(features, lambda x, y: 1 - x, 0.5, above=3, below=2)
ROWS = Quotients(features, lambda x, y: 1 - x, (0.5, 0.0), above=3, below=2)
C = np.array([[0.3, -0.2, 0.1, 0.4, 0.2, -0.1], [0.1, 0.2, 0.3, -0.4, 0.3, 0.25]])


def by_hand(row, offset, x, y):
    t, p1, p2, p3, q1, q2 = row
    return offset + (1 - x) * (t + p1 * x + p2 * y + p3 * x * y) / (1 + q1 * x + q2 * y)


def test_a_quotient_is_offset_plus_factor_times_numerator_over_denominator():
    x, y = 0.3, 0.7
    assert float(ONE(C[0], x, y)) == pytest.approx(by_hand(C[0], 0.5, x, y), rel=1e-15)
    expected = [by_hand(C[0], 0.5, x, y), by_hand(C[1], 0.0, x, y)]
    np.testing.assert_allclose(ROWS(C, x, y), expected, rtol=1e-15)


def test_the_least_denominator_of_all_rows_must_stay_positive():
    x, y = 0.3, 0.7
    denominators = 1 + C[:, 4:] @ [x, y]
    assert float(ONE.positive(C[0], x, y)) == pytest.approx(denominators[0], rel=1e-15)
    assert float(ROWS.positive(C, x, y)) == pytest.approx(denominators.min(), rel=1e-15)


def test_columns_are_the_features_at_every_point():
    points = np.array([[0.1, 0.2], [0.5, -1.0]])
    numerator, below, factor = ROWS.columns(jnp.asarray(points))
    np.testing.assert_allclose(numerator, [[1, 0.1, 0.2, 0.02], [1, 0.5, -1, -0.5]], rtol=1e-15)
    np.testing.assert_array_equal(below, points)
    np.testing.assert_allclose(factor, [0.9, 0.5], rtol=1e-15)


# Fits of one quotient, R's

GRID = trapezoid_grid(RATIONAL_R.axes, 13)
SYNTHETIC = np.concatenate([np.sin(np.arange(14)) / 3, [0.5, -0.4, 0.3]])


@functools.cache
def exact() -> jax.Array:
    return jnp.asarray(RATIONAL_R.reference.values(GRID.points))


@functools.cache
def fitted() -> jax.Array:
    return fit_quotient_on_grid(R_QUOTIENT, GRID, exact())


def norm(coefficients) -> float:
    return float(np.linalg.norm(misfit(RATIONAL_R, GRID, coefficients, exact())))


@pytest.mark.slow
def test_a_quotient_is_recovered_from_its_own_values():
    values = form_values(RATIONAL_R.fitted(SYNTHETIC), GRID.points)
    found = fit_quotient_on_grid(R_QUOTIENT, GRID, jnp.asarray(values))
    assert np.abs(misfit(RATIONAL_R, GRID, found, values)).max() < 1e-8


@pytest.mark.slow
def test_no_direction_in_the_coefficients_lowers_the_error():
    assert possible_gain(RATIONAL_R, GRID, fitted(), exact()) < 1e-3


@pytest.mark.slow
def test_the_second_solver_ends_in_the_same_minimum(monkeypatch):
    first = fitted()
    replace_solver(monkeypatch, quotients, solve_nonlinear_jaxopt, "_fit_quotient")
    second = fit_quotient_on_grid(R_QUOTIENT, GRID, exact())
    assert not np.array_equal(first, second)
    assert norm(second) == pytest.approx(norm(first), rel=1e-6)
    # It is the same function, not only one that is as good.
    apart = form_values(RATIONAL_R.fitted(second), GRID.points)
    apart = apart - form_values(RATIONAL_R.fitted(first), GRID.points)
    largest = np.abs(misfit(RATIONAL_R, GRID, first, exact())).max()
    assert np.abs(apart).max() < 1e-3 * largest * 17


@pytest.mark.slow
def test_the_worst_of_several_starts_is_as_good(monkeypatch):
    replace_solver(monkeypatch, quotients, worst_of(6, 0.3), "_fit_quotient")
    found = fit_quotient_on_grid(R_QUOTIENT, GRID, exact())
    assert norm(found) == pytest.approx(norm(fitted()), rel=1e-6)


# Fits of several rows


def test_rows_are_recovered_together_from_their_own_values():
    points = jnp.asarray(trapezoid_grid(AXES, 7).points)
    wanted = jax.vmap(lambda point: ROWS(C, *point))(points)
    root = np.full(len(points), len(points) ** -0.5)

    @jax.jit
    def fit(points, penalised, targets):
        def errors(values):
            return root[:, None] * (values - targets)

        return fit_quotients(ROWS, points, penalised, root, targets, errors)

    found = fit(points, penalty_points(AXES), wanted)
    assert found.shape == (2, 6)
    again = jax.vmap(lambda point: ROWS(found, *point))(points)
    np.testing.assert_allclose(again, wanted, atol=1e-6)


def test_a_start_is_a_polynomial_with_denominators_of_one(monkeypatch):
    least = norm(fitted())
    replace_solver(monkeypatch, quotients, lambda residual, start, steps: start, "_fit_quotient")
    found = fit_quotient_on_grid(R_QUOTIENT, GRID, exact())
    np.testing.assert_array_equal(found[14:], 0)
    assert 0 < least < norm(found) < 0.1


def test_small_denominators_cost():
    """With a denominator below the floor the residual has a part that pushes it up again."""
    shares = quotients._penalty(jnp.array([1.0, DENOMINATOR_FLOOR, 0.0, -1.0]))
    np.testing.assert_allclose(
        shares, [0, 0, DENOMINATOR_FLOOR / 2, (1 + DENOMINATOR_FLOOR) / 2], rtol=1e-15
    )


def test_the_penalty_is_on_the_closed_domain():
    points = penalty_points(AXES)
    assert points.shape == (17**2, 2)
    np.testing.assert_array_equal(points.min(axis=0), [axis.lower for axis in AXES])
    np.testing.assert_array_equal(points.max(axis=0), [axis.upper for axis in AXES])
