import functools

import jax.numpy as jnp
import numpy as np
import pytest

from fitting.cells import DIRECTIONS_PER_ANGLE, fit_cells, largest_error
from fitting.errors import exact_values
from fitting.paper import RationalPs
from fitting.points.grids import WEIGHTS, Grid, light_directions, trapezoid_grid
from integrals import PS

GRID = trapezoid_grid(RationalPs.axes[:2], 9)
COUNT = 12


@functools.cache
def cells(weight: str = "uniform"):
    return fit_cells(GRID, weight, COUNT)


@functools.cache
def problem(weight: str, row: int, column: int):
    """Give one cell's matrix of Eq. (1)'s functions, exact P_s and weights, all by NumPy."""
    alpha, theta_f = GRID.nodes[0][row], GRID.nodes[1][column]
    lights, weights = light_directions(RationalPs.axes[2], COUNT, weight)
    theta, phi = lights.T
    un = np.cos(theta)
    ut = np.sin(theta) * np.cos(phi) * np.sin(theta_f) + un * np.cos(theta_f)
    matrix = np.stack([np.ones_like(un), un, ut, un * un, un * ut, ut * ut], axis=1)
    material = np.broadcast_to([alpha, theta_f], lights.shape)
    return matrix, exact_values(PS, np.concatenate([material, lights], axis=1)), weights


@pytest.mark.parametrize("weight", WEIGHTS)
@pytest.mark.parametrize("cell", [(0, 0), (3, 5), (0, 8)])
def test_a_cell_has_the_coefficients_and_residual_that_numpy_finds(weight, cell):
    matrix, exact, weights = problem(weight, *cell)
    root = np.sqrt(weights)
    expected, residual, _, _ = np.linalg.lstsq(matrix * root[:, None], exact * root, rcond=None)
    np.testing.assert_allclose(cells(weight).coefficients[cell], expected, atol=1e-10)
    # P_s comes in two forms: from angles here, from cosines there.
    assert cells(weight).residuals[cell] == pytest.approx(residual[0], rel=1e-9)


def test_weights_change_the_optimum():
    uniform, others = cells("uniform").coefficients, WEIGHTS[1:]
    assert all(np.abs(cells(each).coefficients - uniform).max() > 0.01 for each in others)


@pytest.mark.parametrize("cell", [(0, 0), (3, 5)])
def test_factors_give_the_error_of_any_other_coefficients_exactly(cell):
    matrix, exact, weights = problem("uniform", *cell)
    other = np.random.default_rng(0).normal(size=6)
    direct = weights @ (matrix @ other - exact) ** 2
    apart = cells().factors[cell[1]] @ (other - cells().coefficients[cell])
    assert apart @ apart + cells().residuals[cell] == pytest.approx(direct, rel=1e-12)


def test_without_anisotropy_the_constant_one_half_is_found():
    expected = np.broadcast_to([0.5, 0, 0, 0, 0, 0], (9, 6))
    np.testing.assert_allclose(cells().coefficients[-1], expected, atol=1e-12)
    np.testing.assert_allclose(cells().residuals[-1], 0, atol=1e-28)


def test_a_fibre_in_the_surface_has_no_terms_that_are_odd_along_it():
    np.testing.assert_allclose(cells().coefficients[:, -1, [2, 4]], 0, atol=1e-12)
    assert np.abs(cells().coefficients[:-1, :-1, [2, 4]]).min() > 1e-3


def test_more_directions_change_the_best_rms_by_less_than_one_in_a_million():
    grid = trapezoid_grid(RationalPs.axes[:2], 5)
    rms = [
        np.sqrt(grid.weights @ np.ravel(fit_cells(grid, "uniform", count).residuals))
        for count in (DIRECTIONS_PER_ANGLE, 96)
    ]
    assert DIRECTIONS_PER_ANGLE**2 >= 2000
    assert abs(rms[1] - rms[0]) < 1e-6
    # … of an rms that is four orders larger
    assert rms[0] > 0.01


def test_the_limit_of_eq_1_is_the_measured_one():
    # 32 × 33 cells of α in [0.15, 1) and θf in [0.1, π/2], all of the same weight.
    alphas = np.linspace(0.15, 1, 33)[:-1]
    thetas = np.linspace(0.1, np.pi / 2, 33)
    grid = Grid(RationalPs.axes[:2], (alphas, thetas), np.full(32 * 33, 1 / (32 * 33)), "uniform")
    rms = np.sqrt(np.mean(fit_cells(grid, "uniform", 24).residuals))
    assert rms == pytest.approx(0.0113, abs=5e-5)


def test_the_largest_error_is_found_where_it_is():
    coefficients = np.array(cells().coefficients)
    coefficients[4, 2] += [0.5, 0, 0, 0, 0, 0]
    largest, place = largest_error(GRID, "uniform", jnp.asarray(coefficients))
    alpha, theta_f, theta_u, phi = place
    assert (alpha, theta_f) == (GRID.nodes[0][4], GRID.nodes[1][2])
    un = np.cos(theta_u)
    ut = np.sin(theta_u) * np.cos(phi) * np.sin(theta_f) + un * np.cos(theta_f)
    fitted = coefficients[4, 2] @ [1, un, ut, un * un, un * ut, ut * ut]
    exact = exact_values(PS, place[None])[0]
    assert abs(fitted - exact) == pytest.approx(largest, rel=1e-9)
    # No cell was farther off before, and 0.5 was added to this one.
    assert largest > 0.5
