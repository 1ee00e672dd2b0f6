"""One way to fit any form: on a grid, on scattered points, to a goal, with errors and proofs."""

from dataclasses import dataclass

import numpy as np

from fitting.errors import Errors, form_values, judge, measure
from fitting.form import FittedForm, Form
from fitting.goal import LEAST_SQUARES, Goal
from fitting.points.grids import Grid
from fitting.points.sample import Sample
from fitting.proofs.least_error import least_error
from fitting.proofs.pole_proof import certify_denominators
from fitting.proofs.range_proof import certify_range
from fitting.solvers.exchange import Exchange
from fitting.solvers.on_grid import MARQUARDT, GridFit, OnGrid, Progress
from programs.bounding.branch_and_bound import Bounds
from programs.bounding.denominators import DenominatorBound

# Fewer nodes than this an axis leave the 27 coefficients of a row of Eq. (2) undetermined.
MIN_NODES = 9
# More would need over 1 GiB for the Jacobian of the joint fit of P_s.
MAX_NODES = 129
# Denominators of fits to scattered points are shown to be above this.
ENOUGH = 1e-6
# Values of forms of more arguments are not bounded in any number of boxes that can be held.
MOST_AXES = 2


@dataclass(frozen=True)
class Fit:
    """A form with its coefficients, where and how it was made, and how good it is.

    * `grid`: the grid or the scattered points that it was fitted on. `inner` counts the second
      stage's points a node (0: there are none); `measure` names their weights.
    * `solver`: what solved it, in words. `reference_error` bounds the error of the exact values.
    * `certificate`: the proof that no denominator vanishes.
    * `least_error`: no coefficients of the form have a smaller largest error; None: unknown.
    * `range`: bounds of all values; None where they are not shown to lie between 0 and 1.
    * `below`: where it is positive, no value is above the exact one; None: not looked at.
    """

    fitted: FittedForm
    grid: Grid | Sample
    measure: str
    inner: int
    solver: str
    reference_error: float
    on_grid: Errors
    off_grid: Errors
    certificate: DenominatorBound
    goal: Goal = LEAST_SQUARES
    least_error: float | None = None
    range: Bounds | None = None
    below: float | None = None


def fit(
    form: Form,
    goal: Goal = LEAST_SQUARES,
    nodes: int | None = None,
    measure: str = "uniform",
    progress: Progress = lambda _: None,
    exchange: Exchange | None = None,
) -> Fit:
    """Fit a form to the exact values of its quantity.

    With `nodes`, squared errors are first made small on a tensor grid of so many nodes an axis; a
    goal other than that is then pursued on scattered points, from there. Without, all is done on
    scattered points, from the form's own starts. `measure` names one of the quantity's measures, if
    it has several. `progress` is told of each stage; `exchange` is the solver on scattered points.

    Raises ValueError for a number of nodes or a measure that is not allowed, and for a fit with a
    denominator that is not shown to be positive. A bounded goal is refused where it is not proven.
    """
    _require(form, goal, nodes)
    measure = _measure_of(form, measure)
    start = None
    if nodes is not None:
        found = (form.solver or OnGrid()).fit(form, nodes, measure, progress)
        if goal == LEAST_SQUARES:
            return _on_grid(form, found, nodes)
        start = np.asarray(found.coefficients).ravel()
    solver = exchange or Exchange()
    coefficients, sample = solver.fit(form, goal, measure, start, progress)
    progress(f"{form.name}: errors and certificate")
    return _scattered(form, coefficients, sample, goal, measure)


def _require(form: Form, goal: Goal, nodes: int | None) -> None:
    if nodes is not None and not MIN_NODES <= nodes <= MAX_NODES:
        raise ValueError(f"grid = {nodes}: allowed are {MIN_NODES} to {MAX_NODES} nodes an axis")
    if goal.bounded and len(form.axes) > MOST_AXES and form.proofs.margins is None:
        raise ValueError(f"bounded = True: no proof is known that would bound {form.name}")


def _measure_of(form: Form, wanted: str) -> str:
    """Return the measure of a fit; a quantity that has but one takes that, whatever is wanted."""
    measures = form.reference.sampling.measures
    if len(measures) == 1:
        return next(iter(measures))
    if wanted not in measures:
        raise ValueError(f"weight = {wanted!r}: allowed are {', '.join(measures)}")
    return wanted


def _on_grid(form: Form, found: GridFit, nodes: int) -> Fit:
    """Judge a least squares fit on a grid, and prove what can be proven."""
    fitted = form.fitted(found.coefficients)
    certificate = certify_denominators(fitted)
    name = form.reference.name
    if not certificate.holds:
        raise ValueError(
            f"the fit of {name} on {nodes} nodes has a denominator that is not positive "
            f"on its whole domain (bound {certificate.bound:.3g}); try another grid"
        )
    below = None if form.proofs.below is None else form.proofs.below(fitted)
    if below is not None and not below > 0:
        raise ValueError(f"the fit of {name} on {nodes} nodes is not shown to create no energy")
    return Fit(
        fitted=fitted,
        grid=found.grid,
        measure=found.measure,
        inner=found.inner,
        solver=found.solver,
        reference_error=found.reference_error,
        on_grid=found.on_grid,
        off_grid=judge(fitted),
        certificate=certificate,
        goal=getattr(form.solver, "goal", LEAST_SQUARES),
        range=certify_range(fitted),
        below=below,
    )


def _scattered(
    form: Form, coefficients: np.ndarray, sample: Sample, goal: Goal, weights: str
) -> Fit:
    """Judge a fit to scattered points, and prove what can be proven."""
    fitted = form.fitted(coefficients)
    certificate = certify_denominators(fitted, ENOUGH)
    if not certificate.holds:
        raise ValueError(
            f"the fit of {form.name} has a denominator that is not shown to be positive "
            "on its whole domain"
        )
    values = certify_range(fitted)
    if goal.bounded and values is None:
        raise ValueError(
            f"the fit of {form.name} has values that are not shown to be between 0 and 1 "
            "on its whole domain"
        )
    errors = form_values(fitted, sample.points) - sample.exact
    least = None
    if goal.norm == "linf" and goal.side == "both" and np.all(sample.scale == 1):
        least = least_error(form, sample.points, sample.exact, errors)
    return Fit(
        fitted=fitted,
        grid=sample,
        measure=weights,
        inner=0,
        solver=MARQUARDT + ("; linear programs (HiGHS)" if goal.norm == "linf" else ""),
        reference_error=sample.error,
        on_grid=measure(errors, sample.points, form),
        off_grid=judge(fitted),
        certificate=certificate,
        goal=goal,
        least_error=least,
        range=values,
    )
