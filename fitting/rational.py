"""Fits of the paper's rational forms, and the polynomial one.

No fit starts from published constants. A rational form starts from the best polynomial, its
denominator one; a penalty on small denominators then keeps Levenberg–Marquardt from stepping
across a pole, and every start without a pole in the domain that was tried ends in the same minimum
(tests/test_rational.py); starts with one do not.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.cells import Cells
from fitting.grid import Grid, trapezoid_grid
from fitting.paper import RationalG, terms
from fitting.solve import solve_linear, solve_nonlinear

# Denominators are pushed up to this at nodes of a grid of their own, PENALTY_NODES an axis.
DENOMINATOR_FLOOR = 0.02
PENALTY_NODES = 17
# The joint fit ends here: by then it is within 0.1 % of the best that any c₀ … c₅ can do.
JOINT_STEPS = 40
# It uses every other node of a grid that has more than this many an axis: the surfaces are smooth,
# and the time goes with the nodes. Its errors are measured on all of them, and between.
JOINT_NODES = 33


def fit_quadratic_q(grid: Grid, exact: Array) -> Array:
    """Fit Eq. (4) to Q (nodes,) on a grid of d: linear. Returns coefficients (2,)."""

    @jax.jit
    def fit(density: Array, root: Array, exact: Array) -> Array:
        matrix = jnp.stack([density, density**2], axis=1)
        return solve_linear(matrix * root[:, None], (exact - 1) * root)

    return fit(grid.points[:, 0], np.sqrt(grid.weights), exact)


def fit_rational_g(grid: Grid, exact: Array) -> Array:
    """Fit Eq. (3) to G (points,) on a grid of (d, ν). Returns coefficients (4,).

    Starts from the linear problem that multiplying by the denominator leaves.
    """

    @jax.jit
    def fit(d: Array, nu: Array, root: Array, exact: Array) -> Array:
        def residual(c: Array) -> Array:
            return root * (jax.vmap(RationalG(c))(d, nu) - exact)

        matrix = jnp.stack([d * nu, d * nu**2, -exact * nu, -exact * nu**3], axis=1)
        start = solve_linear(matrix * root[:, None], (exact - 1) * d * root)
        return solve_nonlinear(residual, start)

    return fit(*grid.points.T, np.sqrt(grid.weights), exact)


def fit_rational_r(grid: Grid, exact: Array) -> Array:
    """Fit Eq. (5) to R (points,) on a grid of (α, θf). Returns coefficients (17,)."""
    return _fit_rows(grid, (exact - 0.5)[None], denominator_terms=3)[0]


def fit_rational_ps(grid: Grid, cells: Cells) -> Array:
    """Fit Eq. (2) on a grid of (α, θf) so that the error of P̃_s itself is least. Returns (6, 27).

    First six separate fits of the cells' c₀ … c₅ on all nodes, then all 162 coefficients together
    on the sum over directions, which `cells` holds exactly.
    """
    targets = cells.coefficients.reshape(-1, 6).T - jnp.array([[0.5, 0, 0, 0, 0, 0]]).T
    rows = _fit_rows(grid, targets, denominator_terms=13)
    stride = 2 if len(grid.nodes[0]) > JOINT_NODES else 1
    return _fit_jointly(*_every(stride, grid, cells), rows)


def _every(stride: int, grid: Grid, cells: Cells) -> tuple[Grid, Cells]:
    """Keep every `stride`-th node; a grid of an even number of nodes is kept whole."""
    count = len(grid.nodes[0])
    if (count - 1) % stride:
        return grid, cells
    some = slice(None, None, stride)
    kept = Cells(cells.coefficients[some, some], cells.factors[some], cells.residuals[some, some])
    return trapezoid_grid(grid.axes, (count - 1) // stride + 1), kept


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


def _fit_jointly(grid: Grid, cells: Cells, rows: Array) -> Array:
    features, beta = _features(grid)
    numerator = jnp.concatenate([jnp.ones((len(beta), 1)), features], axis=1)
    root = jnp.sqrt(jnp.asarray(grid.weights)).reshape(*cells.residuals.shape, 1)
    penalty_features = _penalty_features(grid)
    offset = jnp.array([0.5, 0, 0, 0, 0, 0])

    @jax.jit
    def fit(start: Array, factors: Array, optimum: Array) -> Array:
        def residual(z: Array) -> Array:
            p, q = z.reshape(6, 27)[:, :14].T, z.reshape(6, 27)[:, 14:].T
            material = offset + beta[:, None] * (numerator @ p) / (1 + features @ q)
            error = jnp.einsum("tij,atj->ati", factors, material.reshape(optimum.shape) - optimum)
            return jnp.concatenate([(root * error).ravel(), _penalty(1 + penalty_features @ q)])

        return solve_nonlinear(residual, start, JOINT_STEPS)

    return fit(rows.ravel(), cells.factors, cells.coefficients).reshape(6, 27)


def _features(grid: Grid) -> tuple[Array, Array]:
    alpha, theta_f = jnp.asarray(grid.points.T)
    return jax.jit(jax.vmap(terms))(alpha, theta_f), 1 - alpha


def _penalty_features(grid: Grid) -> Array:
    return _features(trapezoid_grid(grid.axes, PENALTY_NODES))[0]


def _penalty(denominators: Array) -> Array:
    short = jnp.maximum(DENOMINATOR_FLOOR - denominators, 0).ravel()
    return short / np.sqrt(len(short))
