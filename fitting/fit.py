"""The function `fit`, which fits any form, measures its errors, and proves what can be proven."""

from dataclasses import dataclass

import numpy as np

from fitting.errors import Errors, form_values, judge, measure
from fitting.form import FittedForm, Form
from fitting.goal import LEAST_SQUARES, Goal
from fitting.points.grids import Grid
from fitting.points.sample import Sample
from fitting.proofs.failing_denominator import failing_denominator
from fitting.proofs.least_error import least_error, rows_of
from fitting.proofs.local_optimality import LocalOptimality, local_optimality
from fitting.proofs.pole_proof import certify_denominators
from fitting.proofs.range_proof import certify_range
from fitting.solvers.elsewhere import Counterexamples
from fitting.solvers.exchange import Exchange, ScatteredFit
from fitting.solvers.given import Given
from fitting.solvers.on_grid import GridFit, OnGrid, Progress
from programs.bounding.branch_and_bound import Bounds
from programs.bounding.denominators import DenominatorBound

# 5 nodes an axis or fewer do not determine the 27 coefficients of a row of Eq. (2). 9 nodes give 81
# values, three for each coefficient.
MIN_NODES = 9
# At 1025 nodes an axis there are 2.4e9 exact values of P_s: 1025² materials, 2,304 lights each.
MAX_NODES = 1025
# After a fit to scattered points, the search for a lower bound of the denominators ends once it has
# proven this one: that there is no pole is shown by any positive bound.
ENOUGH = 1e-6
# Over more axes, branch and bound would need too many boxes to bound a form's values. Such a form
# needs margins (`Proofs.margins`) for a bounded goal.
MOST_AXES = 2


@dataclass(frozen=True)
class Fit:
    """A form with its coefficients, how they were found, and how good they are.

    * `fitted`: the form with its coefficients.
    * `grid`: the grid or the scattered points of the fit. On a grid, a form of two stages has
      `inner` points of the second stage at each node; 0 means that there are none.
    * `measure`: the name of the quantity's measure that weighs the errors.
    * `solver`: the solver, in words. `reference_error` is a bound on the error of the exact values.
    * `on_grid`: the errors at the points of the fit. `off_grid`: at points that it did not use.
    * `certificate`: the proof that no denominator vanishes.
    * `goal`: what the fit minimises, and its constraints.
    * `least_error`: the proven lower bound of the largest error that any coefficients of the form
      can have; None if there is no such proof.
    * `local_optimality`: how much a small change of the coefficients could lower the largest error;
      None for another goal, and if there is a `least_error`.
    * `range`: proven bounds of all values, which lie in the codomain up to rounding; None if this
      is not proven.
    * `converged`: whether the solver reached what it looks for: for least squares a minimum, for
      the largest error one that is nowhere larger than at the points of the fit. If it is false,
      `solver` says what happened, and the fit is only as good as its errors say. None if it was not
      examined, as for a form of two stages on a grid.
    * `below`: a number whose positive sign proves that no value is above the exact one; None for a
      form that has no such proof.
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
    local_optimality: LocalOptimality | None = None
    range: Bounds | None = None
    below: float | None = None
    converged: bool | None = None


def fit(
    form: Form,
    goal: Goal = LEAST_SQUARES,
    nodes: int | None = None,
    measure: str = "uniform",
    progress: Progress = lambda _: None,
    exchange: Exchange | Given | None = None,
    counterexamples: Counterexamples | None = None,
) -> Fit:
    """Fit a form to the exact values of its quantity.

    The arguments besides `form` and `goal` are:

    * `nodes`: nodes along each axis of a tensor grid, on which a least squares fit is made. For
      another goal, a fit to scattered points follows, which starts from the coefficients of the
      grid. None: there is only the fit to scattered points, which starts from the form's starts.
    * `measure`: the name of one of the quantity's measures, which weigh the errors. A quantity that
      has only one measure takes that one.
    * `progress`: a function that is called with a short text before each step.
    * `exchange`: the solver on scattered points, or coefficients in its place; None for that of the
      form.
    * `counterexamples`: a search for larger errors than those at the points of a fit of the largest
      error, such as `Problem.counterexamples()` returns.

    Raises ValueError for a number of nodes or a measure that is not allowed, for a fit with a
    denominator that is not proven to be positive, and for a bounded goal if the bounds are not
    proven.
    """
    _require(form, goal, nodes)
    measure = _measure_of(form, measure)
    start = None
    if nodes is not None:
        found = (form.solver or OnGrid()).fit(form, nodes, measure, progress)
        if goal == LEAST_SQUARES:
            return _on_grid(form, found, nodes)
        start = np.asarray(found.coefficients).ravel()
    solver = exchange or form.scattered_solver or Exchange()
    try:
        found = solver.fit(form, goal, measure, start, progress, counterexamples)
    except np.linalg.LinAlgError:
        raise ValueError(
            f"{form.name}: its coefficients cannot be found: allowed is a form whose values are "
            "finite on its whole domain"
        ) from None
    progress(f"{form.name}: errors and certificate")
    return _scattered(form, found, goal, measure)


def _require(form: Form, goal: Goal, nodes: int | None) -> None:
    if nodes is not None and not MIN_NODES <= nodes <= MAX_NODES:
        raise ValueError(f"grid = {nodes}: allowed are {MIN_NODES} to {MAX_NODES} nodes an axis")
    if goal.bounded and len(form.axes) > MOST_AXES and form.proofs.margins is None:
        raise ValueError(f"bounded = True: no proof is known that would bound {form.name}")


def _measure_of(form: Form, wanted: str) -> str:
    """Return the name of the measure to use: the one that is wanted, or the only one.

    Raises ValueError if the quantity has several measures and not the one that is wanted.
    """
    measures = form.reference.sampling.measures
    if len(measures) == 1:
        return next(iter(measures))
    if wanted not in measures:
        raise ValueError(f"weight = {wanted!r}: allowed are {', '.join(measures)}")
    return wanted


def _on_grid(form: Form, found: GridFit, nodes: int) -> Fit:
    """Measure the errors of a least squares fit on a grid, and prove what can be proven."""
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
        converged=found.converged,
    )


def _scattered(form: Form, found: ScatteredFit, goal: Goal, weights: str) -> Fit:
    """Measure the errors of a fit to scattered points, and prove what can be proven."""
    fitted, sample = form.fitted(found.coefficients), found.sample
    certificate = certify_denominators(fitted, ENOUGH)
    if not certificate.holds:
        raise ValueError(f"the fit of {form.name} has {failing_denominator(fitted)}")
    values = certify_range(fitted)
    if goal.bounded and values is None:
        lower, upper = form.reference.codomain
        raise ValueError(
            f"the fit of {form.name} has values that are not shown to be between {lower:g} and "
            f"{upper:g} on its whole domain"
        )
    errors = form_values(fitted, sample.points) - sample.exact
    least = local = None
    if goal.norm == "linf" and goal.side == "both" and np.all(sample.scale == 1):
        least = _least_error(fitted, sample)
        if least is None:
            local = local_optimality(fitted, sample.points, sample.exact, goal.bounded)
    return Fit(
        fitted=fitted,
        grid=sample,
        measure=weights,
        inner=0,
        solver=found.solver,
        reference_error=sample.error,
        on_grid=measure(errors, sample.points, form),
        off_grid=judge(fitted),
        certificate=certificate,
        goal=goal,
        least_error=least,
        local_optimality=local,
        range=values,
        converged=found.converged,
    )


def _least_error(fitted: FittedForm, sample: Sample) -> float | None:
    """Return the lower bound of the largest error of any coefficients, by exact values for it."""
    reference = fitted.reference
    if not (reference.proof_options and fitted.form.has_least_error):
        return least_error(fitted, sample.points, sample.exact, sample.error)
    errors = form_values(fitted, sample.points) - sample.exact
    points = sample.points[rows_of(sample.points, errors)]
    exact = reference.estimates(points, for_proof=True)
    return least_error(fitted, points, np.asarray(exact.value), float(np.max(exact.error)))
