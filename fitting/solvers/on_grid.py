"""Least squares fits on a tensor grid over the whole domain."""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import numpy as np
from jax import Array

from fitting.errors import Errors, form_values, measure
from fitting.form import Form
from fitting.goal import LEAST_SQUARES, Goal
from fitting.linearity import LinearParts, linear_parts
from fitting.points.grids import Grid, MakeGrid, gauss_grid
from fitting.solvers.least_squares import solve_linear, solve_nonlinear
from fitting.solvers.residuals import residuals
from integrals.compilation import jit_for_few_calls

Progress = Callable[[str], None]
# A fit on a grid has converged if the cosine of the angle of the residual with the space of the
# Jacobian's columns is at most this: a linear step would lower the rms error by 5e-6 of it.
STATIONARY = 3e-3
MARQUARDT = "Levenberg–Marquardt (optimistix)"


@dataclass(frozen=True)
class GridFit:
    """The result of a fit on a grid.

    * `on_grid`: the errors on the grid.
    * `reference_error`: a bound on the error of the exact values.
    * `measure`: the name of the measure that weighs the errors.
    * `inner`: the number of the second stage's points at each node; 0 if there are none.
    * `solver`: the solver, in words.
    * `converged`: whether the sum of squared errors is stationary; None if not examined, as
      for a solver of one's own.
    """

    coefficients: Array
    grid: Grid
    on_grid: Errors
    reference_error: float
    measure: str
    inner: int
    solver: str
    converged: bool | None = None


@dataclass(frozen=True)
class OnGrid:
    """The solver of a form on a grid.

    * `make_grid`: makes the grid from axes and a number of nodes an axis.
    * `solve`: returns the coefficients for the grid and the exact values (points,). None stands for
      `solve_in_general`.
    * `description`: names `solve` in words; None stands for Levenberg–Marquardt.
    * `goal`: what `solve` minimises, if that is not the sum of squared errors.
    """

    make_grid: MakeGrid = gauss_grid
    solve: Callable[[Grid, Array], Array] | None = None
    description: str | None = None
    goal: Goal = LEAST_SQUARES

    def fit(self, form: Form, count: int, _measure: str, progress: Progress) -> GridFit:
        """Fit on `count` nodes an axis. Errors are weighed by the grid, not by a measure."""
        grid = self.make_grid(form.axes, count)
        progress(f"exact {form.reference.symbol} on the grid")
        estimates = form.reference.estimates(grid.points)
        progress(f"coefficients of {form.printed or form.name}")
        if self.solve is not None:
            coefficients, solver = self.solve(grid, estimates.value), self.description or MARQUARDT
        else:
            coefficients, solver = solve_in_general(form, grid, estimates.value)
        progress("errors and certificate")
        difference = form_values(form.fitted(coefficients), grid.points)
        difference = difference - np.asarray(estimates.value)
        on_grid = measure(difference, grid.points, form, grid.weights)
        error = float(np.max(np.asarray(estimates.error)))
        converged = None
        if self.solve is None and form.size:
            converged = _is_stationary(form, coefficients, grid, np.asarray(estimates.value))
            solver += "" if converged else "; least squares did not converge"
        return GridFit(coefficients, grid, on_grid, error, "uniform", 0, solver, converged)


def _is_stationary(form: Form, coefficients: Array, grid: Grid, exact: np.ndarray) -> bool:
    """Whether the residual is nearly orthogonal to the columns of the Jacobian."""
    root, z = np.sqrt(grid.weights), np.asarray(coefficients).ravel()
    parts = linear_parts(form, grid.points)
    if parts is None:
        all_free = np.full(form.size, True)
        problem = residuals(form, grid.points, exact, root, all_free, np.zeros(form.size))
        error, slopes = problem.values(z), problem.slopes(z, np.arange(len(exact)))
    else:
        # Nothing has to be compiled for a quotient of linear functions.
        with np.errstate(all="ignore"):
            values, slopes = parts.values_and_slopes(z)
            error, slopes = root * (values - exact), root[:, None] * slopes
    if not (np.isfinite(error).all() and np.isfinite(slopes).all()):
        return False
    norms = np.linalg.norm(slopes, axis=0)
    left, singular, _ = np.linalg.svd(slopes / np.where(norms > 0, norms, 1.0), full_matrices=False)
    tangent = left[:, singular > 1e-12 * singular[0]]
    size = np.linalg.norm(error)
    # An exact fit leaves rounding, which has no direction.
    exactly = 1e-13 * np.linalg.norm(exact * root)
    return bool(size <= exactly or np.linalg.norm(tangent.T @ error) <= STATIONARY * size)


def solve_in_general(form: Form, grid: Grid, exact: Array) -> tuple[Array, str]:
    """Return the flat coefficients of a least squares fit on a grid, and the solver in words.

    A form that is linear in its coefficients is solved by QR. Other forms are fitted by
    Levenberg–Marquardt, and the best result of the form's starts is returned. A quotient of linear
    functions needs no starts: the errors times the denominator are linear in the coefficients, and
    the coefficients that minimise these are the start. Raises ValueError for any other form without
    starts.
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

    ends = [_fit(form, list(points.T), root, np.asarray(exact), np.asarray(s)) for s in starts]
    if len(ends) == 1:
        return ends[0], MARQUARDT

    def rms(end: Array) -> float:
        difference = form_values(form.fitted(end), points) - np.asarray(exact)
        with np.errstate(over="ignore"):
            return float(np.sqrt(np.average(difference**2, weights=grid.weights)))

    return min(ends, key=lambda end: np.nan_to_num(rms(end), nan=np.inf)), MARQUARDT


@jit_for_few_calls(static=(0,))
def _fit(form: Form, columns: list[Array], root: Array, exact: Array, start: Array) -> Array:
    def residual(c: Array) -> Array:
        shaped = c.reshape(form.coefficient_shape)
        return root * (jax.vmap(lambda *point: form(shaped, *point))(*columns) - exact)

    return solve_nonlinear(residual, start)


def _linear(parts: LinearParts, root: np.ndarray, exact: Array) -> Array:
    """Return the coefficients that minimise the errors times the denominator, which are linear."""
    known = np.asarray(exact)
    matrix = parts.a - known[:, None] * parts.b
    values = (known - parts.a0 / parts.b0) * parts.b0 * root
    return _solve_linear(matrix * root[:, None], values)


_solve_linear = jit_for_few_calls(solve_linear)
