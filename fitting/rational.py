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
from fitting.paper import RationalG, terms
from fitting.points.grids import Grid, trapezoid_grid
from fitting.solvers.least_squares import solve_linear, solve_nonlinear

# Denominators are pushed up to this at nodes of a grid of their own, PENALTY_NODES an axis.
DENOMINATOR_FLOOR = 0.02
PENALTY_NODES = 17
# The fit of P_s ends here: by then it is within 0.1 % of the best that any c₀ … c₅ can do.
JOINT_STEPS = 100
# It skips nodes of a grid that has more than this many an axis: the surfaces are smooth, and the
# time goes with the nodes. Its errors are measured on all of them, and between.
JOINT_NODES = 17


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

    @jax.jit
    def fit(points: Array, penalised: Array, root: Array, exact: Array) -> Array:
        numerator, features, beta = _features(points)
        penalty_features = _features(penalised)[1][:, :3]

        def residual(c: Array) -> Array:
            value = 0.5 + beta * (numerator @ c[:14]) / (1 + features[:, :3] @ c[14:])
            return jnp.concatenate(
                [root * (value - exact), _penalty(1 + penalty_features @ c[14:])]
            )

        start = solve_linear((root * beta)[:, None] * numerator, root * (exact - 0.5))
        return solve_nonlinear(residual, jnp.concatenate([start, jnp.zeros(3)]))

    return fit(grid.points, _penalised(grid), np.sqrt(grid.weights), exact)


def fit_rational_ps(grid: Grid, cells: Cells) -> Array:
    """Fit Eq. (2) on a grid of (α, θf) so that the error of P̃_s itself is least. Returns (6, 27).

    All 162 coefficients together, on the sum over directions, which `cells` holds exactly.
    """
    stride = -(-(len(grid.nodes[0]) - 1) // (JOINT_NODES - 1))
    grid, cells = _every(stride, grid, cells)
    root = np.sqrt(grid.weights).reshape(*cells.residuals.shape, 1)
    offset = np.array([0.5, 0, 0, 0, 0, 0])

    @jax.jit
    def fit(points: Array, penalised: Array, factors: Array, optimum: Array) -> Array:
        numerator, features, beta = _features(points)
        penalty_features = _features(penalised)[1]

        def residual(z: Array) -> Array:
            p, q = z.reshape(6, 27)[:, :14].T, z.reshape(6, 27)[:, 14:].T
            material = offset + beta[:, None] * (numerator @ p) / (1 + features @ q)
            error = jnp.einsum("tij,atj->ati", factors, material.reshape(optimum.shape) - optimum)
            return jnp.concatenate([(root * error).ravel(), _penalty(1 + penalty_features @ q)])

        weighted = jnp.asarray(root.reshape(-1, 1))
        surfaces = weighted * (optimum.reshape(-1, 6) - offset)
        start = solve_linear(weighted * beta[:, None] * numerator, surfaces)
        polynomials = jnp.concatenate([start, jnp.zeros((13, 6))]).T
        return solve_nonlinear(residual, polynomials.ravel(), JOINT_STEPS)

    fitted = fit(grid.points, _penalised(grid), cells.factors, cells.coefficients)
    return fitted.reshape(6, 27)


def _every(stride: int, grid: Grid, cells: Cells) -> tuple[Grid, Cells]:
    """Keep every `stride`-th node, or the next fewer that end where the grid does."""
    count = len(grid.nodes[0])
    while (count - 1) % stride:
        stride -= 1
    some = slice(None, None, stride)
    kept = Cells(cells.coefficients[some, some], cells.factors[some], cells.residuals[some, some])
    return trapezoid_grid(grid.axes, (count - 1) // stride + 1), kept


def _features(points: Array) -> tuple[Array, Array, Array]:
    """Give (1, x), x and β at points (n, 2) of (α, θf)."""
    x = jax.vmap(terms)(points[:, 0], points[:, 1])
    return jnp.concatenate([jnp.ones((len(x), 1)), x], axis=1), x, 1 - points[:, 0]


def _penalised(grid: Grid) -> np.ndarray:
    return trapezoid_grid(grid.axes, PENALTY_NODES).points


def _penalty(denominators: Array) -> Array:
    short = jnp.maximum(DENOMINATOR_FLOOR - denominators, 0).ravel()
    return short / np.sqrt(len(short))
