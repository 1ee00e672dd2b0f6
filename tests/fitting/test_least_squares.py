import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting.solvers.least_squares import solve_linear, solve_nonlinear, solve_nonlinear_jaxopt

NONLINEAR = {"optimistix": solve_nonlinear, "jaxopt": solve_nonlinear_jaxopt}


def problem(seed: int, rows: int, columns: int, spread: float):
    """Give a random matrix whose columns differ in size by 10^±spread, and values."""
    random = np.random.default_rng(seed)
    scale = 10.0 ** random.uniform(-spread, spread, columns)
    return random.normal(size=(rows, columns)) * scale, random.normal(size=rows)


@pytest.mark.parametrize("spread", [0.0, 3.0, 8.0])
@pytest.mark.parametrize("shape", [(1, 1), (6, 6), (200, 14)])
def test_the_linear_solver_finds_what_numpy_finds(shape, spread):
    solve = jax.jit(solve_linear)
    for seed in range(20):
        matrix, values = problem(seed, *shape, spread)
        scale = np.linalg.norm(matrix, axis=0)
        expected = np.linalg.lstsq(matrix / scale, values, rcond=None)[0] / scale
        # Both are backward stable: they differ by rounding times the scaled condition number,
        # squared where there is a residual.
        condition = np.linalg.cond(matrix / scale)
        tolerance = 1e-14 * condition**2 * np.linalg.norm(values)
        np.testing.assert_allclose(
            solve(matrix, values) * scale, expected * scale, rtol=0, atol=tolerance
        )


def test_the_linear_solver_takes_several_columns_of_values():
    matrix, values = problem(2, 50, 5, 2.0)
    both = jnp.stack([values, values**2], axis=1)
    expected = [solve_linear(jnp.asarray(matrix), column) for column in both.T]
    np.testing.assert_allclose(solve_linear(jnp.asarray(matrix), both).T, expected, rtol=1e-12)


def test_the_linear_solver_leaves_a_residual_orthogonal_to_the_columns():
    matrix, values = problem(1, 500, 14, 4.0)
    residual = matrix @ np.asarray(solve_linear(jnp.asarray(matrix), jnp.asarray(values))) - values
    scaled = matrix / np.linalg.norm(matrix, axis=0)
    np.testing.assert_allclose(scaled.T @ residual, 0, atol=1e-12)
    assert np.linalg.norm(residual) > 1


# A decaying oscillation by a rational function. No z fits it.
X = jnp.linspace(0, 1, 50)
START = jnp.array([0.5, -0.5, 0.0])


def misfit(z):
    return (z[0] + z[1] * X) / (1 + z[2] * X) - jnp.exp(-X) * jnp.sin(7 * X)


@functools.cache
def minimiser(solver: str) -> jax.Array:
    return jax.jit(functools.partial(NONLINEAR[solver], misfit))(START)


@pytest.mark.parametrize("solver", NONLINEAR)
def test_a_nonlinear_solver_ends_where_the_gradient_vanishes(solver):
    z = minimiser(solver)
    jacobian, residual = jax.jacfwd(misfit)(z), misfit(z)
    # The angle between the residual and each column: 1e-4 leaves 1e-8 of the square sum to gain.
    slopes = (jacobian / jnp.linalg.norm(jacobian, axis=0)).T @ residual
    assert jnp.linalg.norm(residual) < 0.99 * jnp.linalg.norm(misfit(START))
    np.testing.assert_allclose(slopes / jnp.linalg.norm(residual), 0, atol=1e-4)


def test_both_nonlinear_solvers_end_in_the_same_minimum():
    one, other = (misfit(minimiser(solver)) for solver in NONLINEAR)
    assert jnp.linalg.norm(one) == pytest.approx(float(jnp.linalg.norm(other)), rel=1e-7)
    np.testing.assert_allclose(one, other, atol=1e-4)


def rosenbrock(z):
    return jnp.stack([10 * (z[1] - z[0] ** 2), 1 - z[0]])


@pytest.mark.parametrize(("steps", "reaches"), [(2, False), (100, True)])
def test_the_steps_are_a_limit_and_enough_of_them_find_the_exact_solution(steps, reaches):
    found = jax.jit(lambda start: solve_nonlinear(rosenbrock, start, steps))(jnp.array([-1.2, 1.0]))
    assert bool(jnp.linalg.norm(found - 1) < 1e-6) == reaches
