"""Eq. (1) cell by cell: the best combination of its six functions for every material.

For one material the error of P̃_s is linear in c₀ … c₅, so each cell is a linear least squares
problem over directions. Its QR factor R turns the error of any other coefficients c into
|R (c − c*)|² + residual²: the sum over directions is exact, and never has to be formed again.
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.grid import Grid, Weight, light_directions
from fitting.paper import RationalPs, direction_basis
from integrals.ps import scattered_fraction

# 48² = 2,304 directions a cell; 96² change the limit's rms by less than 1e-6 (tests/test_cells.py).
DIRECTIONS_PER_ANGLE = 48


@dataclass(frozen=True)
class Cells:
    """Every cell's optimum: coefficients (α, θf, 6), factors (θf, 6, 6), mean squares (α, θf)."""

    coefficients: Array
    factors: Array
    residuals: Array


def fit_cells(grid: Grid, weight: Weight, count: int = DIRECTIONS_PER_ANGLE) -> Cells:
    """Solve every cell of a grid of (α, θf) by QR over count² weighted directions of light."""
    alphas, thetas = (jnp.asarray(nodes) for nodes in grid.nodes)
    lights, weights = light_directions(RationalPs.axes[2], count, weight)
    coefficients, factors, residuals = _solve(alphas, thetas, lights, weights)
    return Cells(jnp.swapaxes(coefficients, 0, 1), factors, residuals.T)


@jax.jit
def _solve(alphas, thetas, lights, weights):
    def at_tilt(theta_f):
        cos_un, cos_ut = _cosines(lights, theta_f)
        root = jnp.sqrt(weights)
        q, r = jnp.linalg.qr(jax.vmap(direction_basis)(cos_un, cos_ut) * root[:, None])
        exact = _exact(alphas, theta_f, cos_un, cos_ut) * root
        projection = exact @ q
        solved = jax.scipy.linalg.solve_triangular(r, projection.T).T
        return solved, r, jnp.sum((exact - projection @ q.T) ** 2, axis=1)

    return jax.lax.map(at_tilt, thetas)


def largest_error(grid: Grid, weight: Weight, coefficients: Array) -> tuple[float, np.ndarray]:
    """Give the largest |P̃_s − P_s| of coefficients (α, θf, 6) on the cells' directions, and where.

    The place is (α, θf, θu, φ).
    """
    alphas, thetas = (jnp.asarray(nodes) for nodes in grid.nodes)
    lights, _ = light_directions(RationalPs.axes[2], DIRECTIONS_PER_ANGLE, weight)
    largest, index = _largest(alphas, thetas, lights, jnp.swapaxes(coefficients, 0, 1))
    tilt = int(np.argmax(largest))
    row, column = np.unravel_index(int(index[tilt]), (len(alphas), len(lights)))
    place = np.array([alphas[row], thetas[tilt], *lights[column]], dtype=float)
    return float(largest[tilt]), place


@jax.jit
def _largest(alphas, thetas, lights, coefficients):
    def at_tilt(inputs):
        theta_f, rows = inputs
        cos_un, cos_ut = _cosines(lights, theta_f)
        fitted = rows @ jax.vmap(direction_basis)(cos_un, cos_ut).T
        error = jnp.abs(fitted - _exact(alphas, theta_f, cos_un, cos_ut)).ravel()
        return jnp.max(error), jnp.argmax(error)

    return jax.lax.map(at_tilt, (thetas, coefficients))


def _cosines(lights, theta_f):
    theta_u, phi = lights[:, 0], lights[:, 1]
    cos_un = jnp.cos(theta_u)
    in_plane = jnp.sin(theta_u) * jnp.cos(phi)
    return cos_un, in_plane * jnp.sin(theta_f) + cos_un * jnp.cos(theta_f)


def _exact(alphas, theta_f, cos_un, cos_ut):
    row = jax.vmap(scattered_fraction, (0, 0, None, None))
    return jax.vmap(row, (None, None, None, 0))(cos_un, cos_ut, jnp.cos(theta_f), alphas)
