"""Least squares solvers: QR where the problem is linear, Levenberg–Marquardt where it is not."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import Array

Residual = Callable[[Array], Array]


def solve_linear(matrix: Array, values: Array) -> Array:
    """Return the z (n,) that minimises |matrix·z − values|² by QR, for a matrix (m, n) with m ≥ n.

    If `values` is (m, k), each column is a problem of its own, and z is (n, k).
    """
    scale = 1 / jnp.linalg.norm(matrix, axis=0)
    q, r = jnp.linalg.qr(matrix * scale)
    return (scale * jax.scipy.linalg.solve_triangular(r, q.T @ values).T).T


def solve_nonlinear(
    residual: Residual, start: Array, steps: int = 300, rtol: float = 1e-7, atol: float = 1e-9
) -> Array:
    """Minimise |residual(z)|² from `start` (n,) by Optimistix's Levenberg–Marquardt.

    It stops when a step changes both z and the objective by less than `atol` + `rtol` times their
    size, or after `steps` steps. It does not report whether it converged: judge the result by its
    residual.
    """
    # Only this needs them, and their import is slow.
    import lineax as lx  # noqa: PLC0415
    import optimistix as optx  # noqa: PLC0415

    solver = optx.LevenbergMarquardt(rtol=rtol, atol=atol, linear_solver=lx.Normal(lx.Cholesky()))
    solution = optx.least_squares(
        lambda z, _: residual(z), solver, start, max_steps=steps, throw=False
    )
    return solution.value


def solve_nonlinear_jaxopt(residual: Residual, start: Array, steps: int = 300) -> Array:
    """Minimise |residual(z)|² by jaxopt: an independent solver, for comparison in tests."""
    import jaxopt  # noqa: PLC0415  it warns at import, and only the cross-check needs it

    solver = jaxopt.LevenbergMarquardt(residual, maxiter=steps, tol=1e-12, xtol=1e-12, gtol=1e-12)
    return solver.run(start).params
