"""Least squares fits of quotients of known features (fitting/shapes/quotients.py).

A fit starts from the best polynomial, that is, with the denominator 1. It never starts from
published constants. A penalty on small denominators keeps Levenberg–Marquardt from stepping across
a pole. In tests, all starts without a pole in the domain lead to the same minimum, but starts with
a pole do not (tests/fitting/test_quotients.py).
"""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.points.grids import Grid, trapezoid_grid
from fitting.shapes.quotients import Quotients
from fitting.solvers.least_squares import solve_linear, solve_nonlinear
from integrals.compilation import jit_for_few_calls
from integrals.reference import Axis

# The penalty applies to denominators below this. They are evaluated on a grid of their own, which
# has PENALTY_NODES nodes an axis.
DENOMINATOR_FLOOR = 0.02
PENALTY_NODES = 17

# A function from the values (n,) or (n, rows) of the quotients to weighted errors, in any shape.
Errors = Callable[[Array], Array]


def fit_quotients(
    shape: Quotients,
    points: Array,
    penalised: Array,
    root: Array | np.ndarray,
    targets: Array,
    errors: Errors,
    steps: int = 300,
) -> Array:
    """Return the coefficients (k,) or (rows, k) that minimise the sum of squared `errors`.

    * `points` (n, axes): the nodes. `root` (n,): the square roots of their weights.
    * `penalised` (m, axes): the points where denominators are kept above the floor.
    * `targets` (n,) or (n, rows): the values that the quotients should have. Only the polynomial
      that the fit starts from is fitted to them.
    * `steps`: the most steps of Levenberg–Marquardt.

    Call this inside a function that is compiled by `jax.jit`.
    """
    split, offset = shape.above + 1, jnp.asarray(shape.offset)
    numerator, features, factor = shape.columns(jnp.asarray(points))
    penalty_features = shape.columns(penalised)[1]
    rows = targets.shape[1:]
    weights = jnp.asarray(root).reshape(-1, *(1 for _ in rows))
    column = factor.reshape(-1, *(1 for _ in rows))

    def residual(flat: Array) -> Array:
        z = flat.reshape(*rows, -1)
        p, q = z[..., :split].T, z[..., split:].T
        values = offset + column * (numerator @ p) / (1 + features @ q)
        return jnp.concatenate([errors(values).ravel(), _penalty(1 + penalty_features @ q)])

    matrix = (jnp.asarray(root) * factor)[:, None] * numerator
    start = solve_linear(matrix, weights * (targets - offset))
    polynomials = jnp.concatenate([start, jnp.zeros((shape.below, *rows))]).T
    return solve_nonlinear(residual, polynomials.ravel(), steps).reshape(*rows, -1)


def penalty_points(axes: tuple[Axis, ...]) -> np.ndarray:
    """Return the points (n, axes) where denominators are kept above the floor."""
    return trapezoid_grid(axes, PENALTY_NODES).points


def fit_quotient_on_grid(shape: Quotients, grid: Grid, exact: Array) -> Array:
    """Fit one quotient to exact values (points,) on a grid. Returns the coefficients (k,)."""
    return _fit_quotient(
        shape, grid.points, penalty_points(grid.axes), np.sqrt(grid.weights), np.asarray(exact)
    )


@jit_for_few_calls(static=(0,))
def _fit_quotient(
    shape: Quotients, points: Array, penalised: Array, root: Array, exact: Array
) -> Array:
    return fit_quotients(
        shape, points, penalised, root, exact, lambda values: root * (values - exact)
    )


def _penalty(denominators: Array) -> Array:
    short = jnp.maximum(DENOMINATOR_FLOOR - denominators, 0).ravel()
    return short / np.sqrt(len(short))
