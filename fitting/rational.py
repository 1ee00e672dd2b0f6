"""Fits of the paper's rational forms, and the polynomial one.

No fit starts from published constants. A rational form starts from the best polynomial, its
denominator one; a penalty on small denominators then keeps Levenberg–Marquardt from stepping
across a pole, and every start that was tried ends in the same minimum (tests/test_rational.py).
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.cells import Cells
from fitting.grid import Grid, trapezoid_grid
from fitting.paper import RationalPs, terms
from fitting.solve import solve_linear, solve_nonlinear

# Denominators are pushed up to this at nodes of a grid of their own, PENALTY_NODES an axis.
DENOMINATOR_FLOOR = 0.02
PENALTY_NODES = 33
# Steps of the joint fit on every other node, and then on all of them.
COARSE_STEPS = 60
FINE_STEPS = 8


def fit_quadratic_q(grid: Grid, exact: Array) -> Array:
    """Fit Eq. (4) to Q (nodes,) on a grid of d: linear. Returns coefficients (2,)."""
    density, root = jnp.asarray(grid.points[:, 0]), jnp.sqrt(grid.weights)
    matrix = jnp.stack([density, density**2], axis=1)
    return solve_linear(matrix * root[:, None], (exact - 1) * root)


def fit_rational_g(grid: Grid, exact: Array) -> Array:
    """Fit Eq. (3) to G (points,) on a grid of (d, ν). Returns coefficients (4,).

    Starts from the linear problem that multiplying by the denominator leaves.
    """
    d, nu = jnp.asarray(grid.points.T)
    root = jnp.sqrt(grid.weights)

    def residual(c: Array) -> Array:
        # as fitting.paper.RationalG, of all points at once
        return root * (d * (1 + nu * (c[0] + nu * c[1])) / (d + nu * (c[2] + nu**2 * c[3])) - exact)

    matrix = jnp.stack([d * nu, d * nu**2, -exact * nu, -exact * nu**3], axis=1)
    start = solve_linear(matrix * root[:, None], (exact - 1) * d * root)
    return solve_nonlinear(residual, start)


def fit_rational_r(grid: Grid, exact: Array) -> Array:
    """Fit Eq. (5) to R (points,) on a grid of (α, θf). Returns coefficients (17,)."""
    rows = _fit_rows(grid, (exact - 0.5)[None], denominator_terms=3)
    return rows[0]


def fit_rational_ps(grid: Grid, cells: Cells) -> Array:
    """Fit Eq. (2) on a grid of (α, θf) so that the error of P̃_s itself is least. Returns (6, 27).

    First six separate fits of the cells' c₀ … c₅, then all 162 coefficients together on the sum
    over directions, which `cells` holds exactly: on every other node, and finally on all.
    """
    offset = np.array([0.5, 0, 0, 0, 0, 0])
    shape = cells.residuals.shape
    targets = (cells.coefficients - offset).reshape(-1, 6).T
    rows = _fit_rows(grid, targets, denominator_terms=13)
    every = slice(None, None, 2 if shape[0] % 2 and shape[0] > 2 * 13 else 1)
    coarse = trapezoid_grid(grid.axes, len(grid.nodes[0][every]))
    coarse_cells = Cells(
        cells.coefficients[every, every], cells.factors[every], cells.residuals[every, every]
    )
    rows = _fit_jointly(coarse, coarse_cells, rows, COARSE_STEPS)
    return _fit_jointly(grid, cells, rows, FINE_STEPS)


def _fit_rows(grid: Grid, targets: Array, denominator_terms: int) -> Array:
    """Fit β (t + pᵀx) / (1 + qᵀy) to each of targets (rows, points); y are the first terms of x."""
    features, beta = _features(grid)
    root = jnp.sqrt(grid.weights)
    numerator = jnp.concatenate([jnp.ones((len(beta), 1)), features], axis=1)
    penalty_features = _penalty_features(grid)[:, :denominator_terms]

    @jax.jit
    def fit(target: Array) -> Array:
        def residual(z: Array) -> Array:
            denominator = 1 + features[:, :denominator_terms] @ z[14:]
            error = root * (beta * (numerator @ z[:14]) / denominator - target)
            return jnp.concatenate([error, _penalty(1 + penalty_features @ z[14:])])

        matrix = (root * beta)[:, None] * numerator
        start = jnp.concatenate([solve_linear(matrix, root * target), jnp.zeros(denominator_terms)])
        return solve_nonlinear(residual, start)

    return jnp.stack([fit(target) for target in targets])


def _fit_jointly(grid: Grid, cells: Cells, rows: Array, steps: int) -> Array:
    alphas, thetas = (jnp.asarray(nodes) for nodes in grid.nodes)
    root = jnp.sqrt(jnp.asarray(grid.weights)).reshape(len(alphas), len(thetas), 1)
    penalty_features = _penalty_features(grid)

    @jax.jit
    def fit(start: Array, factors: Array, optimum: Array) -> Array:
        def residual(z: Array) -> Array:
            form = RationalPs(z.reshape(6, 27))
            material = jax.vmap(jax.vmap(form.material, (None, 0)), (0, None))(alphas, thetas)
            error = root * jnp.einsum("tij,atj->ati", factors, material - optimum)
            denominators = 1 + penalty_features @ form.coefficients[:, 14:].T
            return jnp.concatenate([error.ravel(), _penalty(denominators)])

        return solve_nonlinear(residual, start, steps)

    return fit(rows.ravel(), cells.factors, cells.coefficients).reshape(6, 27)


def _features(grid: Grid) -> tuple[Array, Array]:
    points = jnp.asarray(grid.points)
    return jax.vmap(terms)(points[:, 0], points[:, 1]), 1 - points[:, 0]


def _penalty_features(grid: Grid) -> Array:
    return _features(trapezoid_grid(grid.axes, PENALTY_NODES))[0]


def _penalty(denominators: Array) -> Array:
    short = jnp.maximum(DENOMINATOR_FLOOR - denominators, 0).ravel()
    return short / np.sqrt(len(short))
