"""Refits of the paper's forms: exact values on a grid, the fit, its errors and certificate."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np

from fitting.cells import DIRECTIONS_PER_ANGLE, fit_cells, largest_error
from fitting.errors import Errors, exact_estimates, form_values, measure, off_grid_errors
from fitting.form import Form
from fitting.goal import LEAST_SQUARES, Goal
from fitting.paper import QuadraticQ, RationalG, RationalPs, RationalR
from fitting.points.grids import WEIGHTS, Grid, Weight, gauss_grid, trapezoid_grid
from fitting.points.sample import Sample
from fitting.proofs.pole_proof import Certificate, certify_denominators
from fitting.proofs.range_proof import certify_range
from fitting.rational import fit_quadratic_q, fit_rational_g, fit_rational_ps, fit_rational_r
from fitting.velvet import ConservativeNorm, certify_conservative, fit_conservative_norm
from programs.bounding.branch_and_bound import Bounds

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Fit:
    """A form with its coefficients, where and how it was made, and how good it is.

    `directions` is the number of lights a node (0 where the integral has none). No coefficients of
    the form have a largest error below `lower_bound`, where one is known; where
    `conservative_bound` is positive, no value is above the exact one. `range` is None where the
    values are not shown to lie between 0 and 1.
    """

    form: Form
    grid: Grid | Sample
    weight: Weight
    directions: int
    solver: str
    reference_error: float
    on_grid: Errors
    off_grid: Errors
    certificate: Certificate
    goal: Goal = LEAST_SQUARES
    lower_bound: float | None = None
    range: Bounds | None = None
    conservative_bound: float | None = None


def refit(name: str, count: int, weight: Weight, progress: Progress = lambda _: None) -> Fit:
    """Refit a quantity's form, of published ones the paper's, on `count` nodes an axis.

    `weight` is the measure of light directions in the fit of P_s; the other integrals have none.
    `progress` is told of each stage. Raises ValueError for another name or weight, for a grid with
    fewer nodes than the form has degrees of freedom or too many to hold, and for a fit that has a
    pole in its domain.
    """
    if name not in REFITS:
        raise ValueError(f"name = {name!r}: allowed are {', '.join(REFITS)}")
    if not MIN_NODES <= count <= MAX_NODES:
        raise ValueError(f"grid = {count}: allowed are {MIN_NODES} to {MAX_NODES} nodes an axis")
    if weight not in WEIGHTS:
        raise ValueError(f"weight = {weight!r}: allowed are {', '.join(WEIGHTS)}")
    fit = REFITS[name](count, weight, progress)
    if not fit.certificate.holds:
        raise ValueError(
            f"the fit of {name} on {count} nodes has a denominator that is not positive "
            f"on its whole domain (bound {fit.certificate.bound:.3g}); try another grid"
        )
    return fit


# Fewer nodes than this leave the 27 coefficients of a row of Eq. (2) undetermined.
MIN_NODES = 9
# More would need over 1 GiB for the Jacobian of the joint fit.
MAX_NODES = 129


def _refit_ps(count: int, weight: Weight, progress: Progress) -> Fit:
    grid = trapezoid_grid(RationalPs.axes[:2], count)
    progress("exact P_s and the best combination of Eq. (1) in every cell")
    cells = fit_cells(grid, weight)
    progress("162 coefficients of Eq. (2) together")
    form = RationalPs(fit_rational_ps(grid, cells))
    progress("errors and certificate")
    points = jnp.asarray(grid.points)
    material = jax.jit(jax.vmap(form.material))(points[:, 0], points[:, 1])
    material = material.reshape(*cells.residuals.shape, 6)
    deviation = jnp.einsum("tij,atj->ati", cells.factors, material - cells.coefficients)
    square = jnp.sum(deviation**2, axis=2) + cells.residuals
    largest, place = largest_error(grid, weight, material)
    on_grid = Errors(
        rms=float(jnp.sqrt(jnp.average(square.ravel(), weights=grid.weights))),
        largest=largest,
        where={axis.name: float(x) for axis, x in zip(RationalPs.axes, place, strict=True)},
        points=len(grid.weights) * DIRECTIONS_PER_ANGLE**2,
    )
    solver = "QR per cell; Levenberg–Marquardt (optimistix) of all coefficients together"
    error = 4 * np.finfo(float).eps / RationalPs.axes[0].lower
    return _judged(form, grid, weight, DIRECTIONS_PER_ANGLE**2, solver, error, on_grid)


def _simple(form: type[Form], make_grid, fit, solver: str):
    def run(count: int, weight: Weight, progress: Progress) -> Fit:
        grid = make_grid(form.axes, count)
        progress(f"exact {form.integral.symbol} on the grid")
        estimates = exact_estimates(form.integral, grid.points)
        progress(f"coefficients of {form.equation}")
        fitted = form(fit(grid, estimates.value))
        progress("errors and certificate")
        difference = form_values(fitted, grid.points) - np.asarray(estimates.value)
        on_grid = measure(difference, grid.points, form, grid.weights)
        error = float(np.max(estimates.error))
        return _judged(fitted, grid, "uniform", 0, solver, error, on_grid)

    return run


def _judged(form, grid, weight, directions, solver, reference_error, on_grid) -> Fit:
    return Fit(
        form=form,
        grid=grid,
        weight=weight,
        directions=directions,
        solver=solver,
        reference_error=reference_error,
        on_grid=on_grid,
        off_grid=off_grid_errors(form),
        certificate=certify_denominators(form),
        range=certify_range(form),
    )


def _refit_velvet(count: int, weight: Weight, progress: Progress) -> Fit:
    run = _simple(ConservativeNorm, trapezoid_grid, fit_conservative_norm, "linear program (HiGHS)")
    fit = run(count, weight, progress)
    bound = certify_conservative(fit.form).bound
    if not bound > 0:
        raise ValueError(f"the fit of velvet on {count} nodes is not shown to create no energy")
    goal = Goal(norm="linf", relative=True, side="below")
    return replace(fit, goal=goal, conservative_bound=bound)


_MARQUARDT = "Levenberg–Marquardt (optimistix)"
REFITS = {
    "ps": _refit_ps,
    "g": _simple(RationalG, gauss_grid, fit_rational_g, _MARQUARDT),
    "q": _simple(QuadraticQ, gauss_grid, fit_quadratic_q, "QR"),
    "r": _simple(RationalR, trapezoid_grid, fit_rational_r, _MARQUARDT),
    "velvet": _refit_velvet,
}
