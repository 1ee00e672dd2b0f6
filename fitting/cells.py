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

from fitting.paper import RationalPs, direction_basis
from fitting.points.grids import Grid, Weight, light_directions
from integrals.fuzz.ps import scattered_fraction
from shading import direction_cosines

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
    lights, weights = light_directions(RationalPs.axes[2], count, weight)
    coefficients, factors, residuals = _solve(grid.nodes[1], lights, weights, _exact(grid, lights))
    return Cells(jnp.swapaxes(coefficients, 0, 1), factors, residuals.T)


def largest_error(grid: Grid, weight: Weight, coefficients: Array) -> tuple[float, np.ndarray]:
    """Give the largest |P̃_s − P_s| of coefficients (α, θf, 6) on the cells' directions, and where.

    The place is (α, θf, θu, φ).
    """
    alphas, thetas = grid.nodes
    lights, _ = light_directions(RationalPs.axes[2], DIRECTIONS_PER_ANGLE, weight)
    exact = _exact(grid, lights)
    largest, index = _largest(thetas, lights, exact, jnp.swapaxes(coefficients, 0, 1))
    tilt = int(np.argmax(largest))
    row, column = np.unravel_index(int(index[tilt]), (len(alphas), len(lights)))
    place = np.array([alphas[row], thetas[tilt], *lights[column]], dtype=float)
    return float(largest[tilt]), place


@jax.jit
def _solve(thetas, lights, weights, exact):
    root = jnp.sqrt(weights)

    def at_tilt(inputs):
        theta_f, values = inputs
        q, r = jnp.linalg.qr(_basis(lights, theta_f) * root[:, None])
        projection = values * root @ q
        solved = jax.scipy.linalg.solve_triangular(r, projection.T).T
        return solved, r, jnp.sum((values * root - projection @ q.T) ** 2, axis=1)

    return jax.lax.map(at_tilt, (thetas, exact))


@jax.jit
def _largest(thetas, lights, exact, coefficients):
    def at_tilt(inputs):
        theta_f, values, rows = inputs
        error = jnp.abs(rows @ _basis(lights, theta_f).T - values).ravel()
        return jnp.max(error), jnp.argmax(error)

    return jax.lax.map(at_tilt, (thetas, exact, coefficients))


def _basis(lights, theta_f):
    return jax.vmap(direction_basis)(*_cosines(lights, theta_f))


def _cosines(lights, theta_f):
    theta_u, phi = lights.T
    return jax.vmap(direction_cosines, (None, 0, 0))(theta_f, theta_u, jnp.cos(phi))


def _exact(grid: Grid, lights: np.ndarray) -> Array:
    """Give the exact P_s (θf, α, lights) of a grid's materials."""
    return _exact_values(*grid.nodes, lights)


# One compilation for both of its callers; within a loop XLA keeps the root in vector registers.
@jax.jit
def _exact_values(alphas, thetas, lights):
    row = jax.vmap(scattered_fraction, (0, 0, None, None))

    def at_tilt(theta_f):
        cos_un, cos_ut = _cosines(lights, theta_f)
        return jax.vmap(row, (None, None, None, 0))(cos_un, cos_ut, jnp.cos(theta_f), alphas)

    return jax.lax.map(at_tilt, thetas)
