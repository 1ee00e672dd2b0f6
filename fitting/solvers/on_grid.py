"""Least squares fits on a tensor grid of the whole domain, with errors measured on the grid."""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.errors import Errors, form_values, measure
from fitting.form import Form
from fitting.goal import LEAST_SQUARES, Goal
from fitting.linearity import LinearParts, linear_parts
from fitting.points.grids import Grid, MakeGrid, gauss_grid
from fitting.solvers.least_squares import solve_linear, solve_nonlinear

Progress = Callable[[str], None]
MARQUARDT = "Levenberg–Marquardt (optimistix)"


@dataclass(frozen=True)
class GridFit:
    """What a fit on a grid gives: coefficients, the grid, and errors on it.

    `measure` names the weights that were chosen; `inner` counts the second stage's points a node (0
    where there are none); `solver` is what solved it, in words.
    """

    coefficients: Array
    grid: Grid
    on_grid: Errors
    reference_error: float
    measure: str
    inner: int
    solver: str


@dataclass(frozen=True)
class OnGrid:
    """Solver of a form on a grid of its own: `make_grid` makes it, `solve` finds the coefficients.

    `solve` takes the grid and the exact values (points,); None stands for the general solver.
    `goal` is what such a fit makes small, if that is not the squares of the errors.
    """

    make_grid: MakeGrid = gauss_grid
    solve: Callable[[Grid, Array], Array] | None = None
    description: str | None = None
    goal: Goal = LEAST_SQUARES

    def fit(self, form: Form, count: int, _measure: str, progress: Progress) -> GridFit:
        """Fit on `count` nodes an axis."""
        grid = self.make_grid(form.axes, count)
        progress(f"exact {form.reference.symbol} on the grid")
        estimates = form.reference.estimates(grid.points)
        progress(f"coefficients of {form.equation}")
        if self.solve is not None:
            coefficients, solver = self.solve(grid, estimates.value), self.description or MARQUARDT
        else:
            coefficients, solver = solve_in_general(form, grid, estimates.value)
        progress("errors and certificate")
        difference = form_values(form.fitted(coefficients), grid.points)
        difference = difference - np.asarray(estimates.value)
        on_grid = measure(difference, grid.points, form, grid.weights)
        error = float(np.max(estimates.error))
        return GridFit(coefficients, grid, on_grid, error, "uniform", 0, solver)


def solve_in_general(form: Form, grid: Grid, exact: Array) -> tuple[Array, str]:
    """Return the coefficients (flat) of a least squares fit on a grid, and the solver in words.

    A form that is linear in its coefficients is solved by QR. Others go to Levenberg–Marquardt,
    from the form's own starts or, if it is a quotient of linear functions, from the linear problem
    that is left when the error is multiplied by the denominator.
    """
    root, points = np.sqrt(grid.weights), grid.points
    parts = linear_parts(form, points)
    if parts is not None and parts.is_linear:
        return _linear(parts, root, exact), "QR"
    starts = list(form.starts)
    if not starts:
        if parts is None:
            raise ValueError(f"{form.name} has no starts: give one")
        starts = [_linear(parts, root, exact)]

    @jax.jit
    def fit(columns: list[Array], root: Array, exact: Array, start: Array) -> Array:
        def residual(c: Array) -> Array:
            shaped = c.reshape(form.coefficient_shape)
            return root * (jax.vmap(lambda *point: form(shaped, *point))(*columns) - exact)

        return solve_nonlinear(residual, start)

    ends = [fit(list(points.T), root, exact, jnp.asarray(start)) for start in starts]
    if len(ends) == 1:
        return ends[0], MARQUARDT

    def rms(end: Array) -> float:
        difference = form_values(form.fitted(end), points) - np.asarray(exact)
        return float(np.sqrt(np.average(difference**2, weights=grid.weights)))

    return min(ends, key=lambda end: np.nan_to_num(rms(end), nan=np.inf)), MARQUARDT


def _linear(parts: LinearParts, root: np.ndarray, exact: Array) -> Array:
    """Solve the linear problem whose errors are multiplied by the denominator."""
    known = np.asarray(exact)
    matrix = parts.a - known[:, None] * parts.b
    values = (known - parts.a0 / parts.b0) * parts.b0 * root
    return jax.jit(solve_linear)(matrix * root[:, None], values)
