"""A second opinion about a fit: another solver, from other starts, at the same points."""

import warnings
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from fitting.fit import Fit
from fitting.form import Form
from fitting.goal import Goal
from fitting.points.grids import Grid
from fitting.points.sample import Sample, scale_at
from fitting.solvers.least_squares import solve_nonlinear_jaxopt
from fitting.solvers.minimax import Minimax
from fitting.solvers.residuals import Residuals, badness, limits, residuals
from fitting.solvers.starts import quotient_starts

# The number of starts near the fit, whose coefficients are multiplied by e to a normally
# distributed number with the deviation `SPREAD`.
STARTS, SPREAD = 4, 0.3
_SEED = 19630612
# The other solver's steps.
_STEPS = 500
# Both end in the same place if their values differ by at most this part of the fit's error. The
# rounding of the values, relative to the largest one, is added.
SAME, ROUNDING = 0.01, 1e-10
# The other end is better if its error is smaller by more than this part.
BETTER = 1e-3


@dataclass(frozen=True)
class SecondOpinion:
    """What another solver found.

    * `agreed`: whether its best end has the same values as the fit, to 1 % of the fit's error.
    * `better`: whether its error is smaller, by more than a thousandth.
    * `error`, `other_error`: what the goal minimises, at the points of the fit: the rms error, or
      the largest error. Both are weighted as the goal says.
    * `values`: the largest difference of the values at these points.
    * `coefficients`: the largest difference of a coefficient, relative to its larger size.
    * `other` (m,): the coefficients of the best end, flat. `tried`: the number of starts.
    """

    agreed: bool
    better: bool
    error: float
    other_error: float
    values: float
    coefficients: float
    other: np.ndarray
    tried: int


def second_opinion(form: Form, goal: Goal, fit: Fit) -> SecondOpinion:
    """Refit a form with jaxopt from other starts, at the points of a fit, and compare.

    The starts are near the fit's coefficients, and for a quotient of linear functions those of
    `quotient_starts`. For the largest error, jaxopt's least squares are the start of linear
    programs. Raises ValueError for a fit with rounded coefficients, for a form without
    coefficients, and for a fit on a grid of two stages, whose points are not kept.
    """
    if goal.rounding != "none":
        raise ValueError(f"rounding = {goal.rounding!r}: a second opinion needs 'none'")
    if not form.size:
        raise ValueError(f"{form.name} has no coefficients")
    sample = _sample_of(form, goal, fit)
    free, fixed = np.full(form.size, True), np.zeros(form.size)
    problem = residuals(form, sample.points, sample.exact, sample.scale, free, fixed, goal.bounded)
    known = fit.fitted.constants.ravel()
    random = np.random.default_rng(_SEED)
    starts = [known * np.exp(SPREAD * random.normal(size=form.size)) for _ in range(STARTS)]
    starts += quotient_starts(problem)
    ends = _refit(form, sample, problem, goal, known, starts)
    sizes = [_attained(problem, goal, end) for end in ends]
    other, found = ends[int(np.argmin(sizes))], _attained(problem, goal, known)
    apart = problem.values(other) - problem.values(known)
    values = float(np.max(np.abs(apart / sample.scale), initial=0.0))
    allowed = SAME * found + ROUNDING * float(np.max(np.abs(sample.exact * sample.scale)))
    both = np.maximum(np.maximum(np.abs(known), np.abs(other)), 1e-300)
    return SecondOpinion(
        agreed=bool(np.max(np.abs(apart)) <= allowed),
        better=bool(min(sizes) < found * (1 - BETTER)),
        error=found,
        other_error=float(min(sizes)),
        values=values,
        coefficients=float(np.max(np.abs(known - other) / both)),
        other=other,
        tried=len(starts),
    )


def _sample_of(form: Form, goal: Goal, fit: Fit) -> Sample:
    """Return the points of a fit. Those of a grid have the square roots of its weights."""
    if isinstance(fit.grid, Sample):
        return fit.grid
    if fit.inner:
        raise ValueError(
            f"{form.name} was fitted on a grid of two stages: "
            "a second opinion needs a fit to scattered points"
        )
    grid: Grid = fit.grid
    estimates = form.reference.estimates(grid.points)
    exact = np.asarray(estimates.value)
    scale = scale_at(grid.points, exact, form, goal, fit.measure)
    scale = scale * np.sqrt(grid.weights * len(exact))
    return Sample(grid.points, exact, float(np.max(estimates.error)), scale)


def _refit(form: Form, sample: Sample, problem: Residuals, goal: Goal, known: np.ndarray, starts):
    """Return where jaxopt's descents from the starts end; a start, if its end is not finite."""
    slopes = problem.slopes(known, np.arange(len(sample.exact)))
    norms = np.linalg.norm(slopes, axis=0)
    unit = 1 / np.where(norms > 0, norms, 1.0)
    points, exact, scale = map(jnp.asarray, (sample.points, sample.exact, sample.scale))

    def residual(scaled):
        c = (scaled * unit).reshape(form.coefficient_shape)
        return scale * (jax.vmap(lambda point: form(c, *point))(points) - exact)

    descend = jax.jit(lambda start: solve_nonlinear_jaxopt(residual, start, _STEPS))
    ends = []
    for start in starts:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # jaxopt says at import that it is not maintained
            end = np.asarray(descend(jnp.asarray(start / unit))) * unit
        end = end if np.isfinite(end).all() and problem.is_good(end) else start
        ends.append(Minimax()(problem, end, goal.side) if goal.norm == "linf" else end)
    return ends


def _attained(problem: Residuals, goal: Goal, z: np.ndarray) -> float:
    """Return the rms or the largest weighted error; ∞ if the form has a pole at a point."""
    if not problem.is_good(z):
        return np.inf
    error = problem.values(z)
    if goal.norm == "l2":
        return float(np.sqrt(np.mean(error**2)))
    return float(np.max(badness(error, *limits(problem, goal.side))))
