"""How to tell that a least squares fit has ended in the minimum, and in which."""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting import Form, form_values
from fitting.points.grids import Grid
from fitting.solvers import quotients, separable
from fitting.solvers.least_squares import solve_nonlinear
from integrals.compilation import jit_for_few_calls


def misfit(form: Form, grid: Grid, coefficients, values) -> np.ndarray:
    """Return the weighted differences of a form and the values on its grid."""
    return np.sqrt(grid.weights) * (form_values(form.fitted(coefficients), grid.points) - values)


def possible_gain(form: Form, grid: Grid, found: Array, values) -> float:
    """Return which part of the error the best linear step of the coefficients would take away."""
    at_points = jax.jit(jax.vmap(lambda c, x: form(c, *x), (None, 0)))
    points, root = jnp.asarray(grid.points), np.sqrt(grid.weights)
    jacobian = jax.jit(jax.jacfwd(at_points))(found, points)
    residual = root * (at_points(found, points) - values)
    # The projection of the residual on the tangent space.
    basis, _ = np.linalg.qr(root[:, None] * jacobian)
    return float(np.linalg.norm(basis.T @ residual) / np.linalg.norm(residual))


def worst_of(count: int, size: float):
    """Return a solver that starts `count` times near the given start, and returns the worst end.

    `size` is the standard deviation of what is added to each unknown.
    """

    def solve(residual, start, steps=300):
        noise = size * jax.random.normal(jax.random.key(3), (count, len(start)))
        ends = jax.lax.map(lambda z: solve_nonlinear(residual, z, steps), start + noise)
        norms = jax.vmap(lambda z: jnp.linalg.norm(residual(z)))(ends)
        return ends[jnp.argmax(jnp.nan_to_num(norms, nan=jnp.inf))]

    return solve


def replace_solver(
    monkeypatch, module, solve, compiled: str, static: tuple[int, ...] = (0,)
) -> None:
    """Let a module's fits be solved by `solve`. `compiled` is its function that holds the solver.

    It is compiled anew, since JAX keeps what it compiled with the module's own solver. Another
    function stands for it, or JAX would know it again.
    """
    whole = getattr(module, compiled).__wrapped__
    monkeypatch.setattr(quotients if module is separable else module, "solve_nonlinear", solve)

    def another(*arguments):
        return whole(*arguments)

    monkeypatch.setattr(module, compiled, jit_for_few_calls(another, static=static))
