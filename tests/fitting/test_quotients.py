import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting import rational
from fitting.cells import fit_cells
from fitting.errors import exact_values, form_values
from fitting.paper import QuadraticQ, RationalG, RationalPs, RationalR
from fitting.points.grids import gauss_grid, trapezoid_grid
from fitting.rational import fit_quadratic_q, fit_rational_g, fit_rational_ps, fit_rational_r
from fitting.solvers.least_squares import solve_nonlinear, solve_nonlinear_jaxopt

FITS = {
    "g": (RationalG, gauss_grid(RationalG.axes, 17), fit_rational_g),
    "q": (QuadraticQ, gauss_grid(QuadraticQ.axes, 17), fit_quadratic_q),
    "r": (RationalR, trapezoid_grid(RationalR.axes, 13), fit_rational_r),
}
# Coefficients of moderate size, whose denominators have no zero.
SYNTHETIC = {
    "g": np.array([-0.8, 0.3, 0.9, -0.2]),
    "q": np.array([-1.5, 0.7]),
    "r": np.concatenate([np.sin(np.arange(14)) / 3, [0.5, -0.4, 0.3]]),
}


@functools.cache
def exact(name: str) -> jax.Array:
    form, grid, _ = FITS[name]
    return jnp.asarray(exact_values(form.integral, grid.points))


def misfit(name: str, coefficients, values) -> np.ndarray:
    """Give the weighted differences of a form and the values on its grid."""
    form, grid, _ = FITS[name]
    return np.sqrt(grid.weights) * (form_values(form(coefficients), grid.points) - values)


def norm(name: str, coefficients) -> float:
    return float(np.linalg.norm(misfit(name, coefficients, exact(name))))


@functools.cache
def fitted(name: str) -> jax.Array:
    _, grid, fit = FITS[name]
    return fit(grid, exact(name))


@pytest.mark.parametrize("name", FITS)
def test_a_form_is_recovered_from_its_own_values(name):
    form, grid, fit = FITS[name]
    values = form_values(form(jnp.asarray(SYNTHETIC[name])), grid.points)
    found = fit(grid, jnp.asarray(values))
    assert np.abs(misfit(name, found, values)).max() < 1e-8


@pytest.mark.parametrize("name", FITS)
def test_no_direction_in_the_coefficients_lowers_the_error(name):
    form, grid, _ = FITS[name]
    found = fitted(name)
    values = jax.jit(jax.vmap(lambda c, x: form(c)(*x), (None, 0)))
    jacobian = jax.jit(jax.jacfwd(values))(found, jnp.asarray(grid.points))
    root = np.sqrt(grid.weights)
    residual = root * (values(found, jnp.asarray(grid.points)) - exact(name))
    # What the best linear step gains: the projection of the residual on the tangent space.
    basis, _ = np.linalg.qr(root[:, None] * jacobian)
    gain = np.linalg.norm(basis.T @ residual) / np.linalg.norm(residual)
    assert gain < 1e-3


def test_the_polynomial_is_the_one_that_numpy_finds():
    _, grid, _ = FITS["q"]
    density, root = grid.points[:, 0], np.sqrt(grid.weights)
    matrix = np.stack([density, density**2], axis=1) * root[:, None]
    expected = np.linalg.lstsq(matrix, (np.asarray(exact("q")) - 1) * root, rcond=None)[0]
    np.testing.assert_allclose(fitted("q"), expected, rtol=1e-12)


@pytest.mark.parametrize("name", ["g", pytest.param("r", marks=pytest.mark.slow)])
def test_the_second_solver_ends_in_the_same_minimum(monkeypatch, name):
    form, grid, fit = FITS[name]
    first = fitted(name)
    monkeypatch.setattr(rational, "solve_nonlinear", solve_nonlinear_jaxopt)
    second = fit(grid, exact(name))
    assert not np.array_equal(first, second)
    assert norm(name, second) == pytest.approx(norm(name, first), rel=1e-6)
    # The same function, not only as good a one: a thousandth of the error apart at most.
    apart = form_values(form(second), grid.points) - form_values(form(first), grid.points)
    assert np.abs(apart).max() < 1e-3 * np.abs(misfit(name, first, exact(name))).max() * 17


def worst_of(count: int, size: float):
    """Make a solver that starts `count` times, `size` from where it is told, and gives the worst.

    `size` is the standard deviation of what is added to each unknown.
    """

    def solve(residual, start, steps=300):
        noise = size * jax.random.normal(jax.random.key(3), (count, len(start)))
        ends = jax.lax.map(lambda z: solve_nonlinear(residual, z, steps), start + noise)
        norms = jax.vmap(lambda z: jnp.linalg.norm(residual(z)))(ends)
        return ends[jnp.argmax(jnp.nan_to_num(norms, nan=jnp.inf))]

    return solve


@pytest.mark.parametrize(
    ("name", "size"), [("g", 0.1), pytest.param("r", 0.3, marks=pytest.mark.slow)]
)
def test_the_worst_of_several_starts_is_as_good(monkeypatch, name, size):
    _, grid, fit = FITS[name]
    monkeypatch.setattr(rational, "solve_nonlinear", worst_of(6, size))
    assert norm(name, fit(grid, exact(name))) == pytest.approx(norm(name, fitted(name)), rel=1e-6)


MATERIALS = trapezoid_grid(RationalPs.axes[:2], 13)


@functools.cache
def cells():
    return fit_cells(MATERIALS, "uniform", 16)


def ps_rms(rows) -> float:
    material = jax.jit(jax.vmap(RationalPs(rows).material))(*MATERIALS.points.T)
    apart = material.reshape(13, 13, 6) - cells().coefficients
    error = np.einsum("tij,atj->ati", cells().factors, apart)
    square = np.sum(error**2, axis=2) + cells().residuals
    return float(np.sqrt(MATERIALS.weights @ np.ravel(square)))


def limit() -> float:
    return float(np.sqrt(MATERIALS.weights @ np.ravel(cells().residuals)))


def test_p_s_comes_close_to_the_best_of_every_cell_and_polynomials_do_not(monkeypatch):
    assert limit() < ps_rms(fit_rational_ps(MATERIALS, cells())) < 1.002 * limit()
    monkeypatch.setattr(rational, "solve_nonlinear", lambda residual, start, steps: start)
    assert ps_rms(fit_rational_ps(MATERIALS, cells())) > 1.01 * limit()


@pytest.mark.slow
def test_p_s_ends_as_near_from_the_worst_of_several_starts(monkeypatch):
    monkeypatch.setattr(rational, "solve_nonlinear", worst_of(4, 0.1))
    assert ps_rms(fit_rational_ps(MATERIALS, cells())) < 1.002 * limit()
