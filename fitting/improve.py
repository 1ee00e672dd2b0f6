"""Fits of any form to a goal: a norm, a side, and the precision that its coefficients are kept in.

From the best of several least squares fits, the largest error is made least by linear programs
where the goal asks for it; then coefficients are rounded in turns, those that matter most first,
and the others are fitted again.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.errors import (
    check_reference,
    climb,
    exact_values,
    form_values,
    measure,
    off_grid_errors,
)
from fitting.fit import Fit, Progress
from fitting.form import Form
from fitting.goal import Goal
from fitting.points.grids import Weight
from fitting.points.sample import SEED, Sample, sample_at, sample_of, scale_at
from fitting.points.scattered import COUNTS
from fitting.proofs.pole_proof import certify_denominators
from fitting.proofs.range_proof import certify_range
from fitting.solvers.least_squares import solve_nonlinear
from fitting.solvers.minimax import (
    Residuals,
    badness,
    limits,
    linear_parts,
    lower_bound,
    minimise_largest,
    residuals,
)

# Steps, and fewer for forms of many coefficients, which step slowly.
STEPS, STEPS_OF_MANY, MANY = 1000, 200, 20
# What must stay positive is pushed up to this in least squares.
PENALTY_FLOOR = 1e-2
# Iterations that multiply a quotient's error by its last denominator.
LINEARISED = 8
# The worst points of elsewhere are added at most this many times, so many of a finer set, until
# none of them has an error that is larger by this part.
EXCHANGES, EXCHANGED, SETTLED = 8, 300, 1e-3
# Denominators are shown to be above this.
ENOUGH = 1e-6
# Values of forms of more arguments are not bounded in any number of boxes that can be held.
MOST_AXES = 2
# Coefficients are rounded in this many turns.
TURNS = 4
PRECISIONS = {"float32": np.float32, "float16": np.float16}


def improve(
    form: type[Form],
    goal: Goal,
    progress: Progress = lambda _: None,
    start: np.ndarray | None = None,
    weight: Weight = "uniform",
) -> Fit:
    """Fit a form to a goal on its sample, from its own starts or from `start`.

    `weight` is the measure of lights in the fit of P_s (fitting/samples.py). Raises ValueError
    where no start gives a form without poles, where the result has one, and where the goal is
    bounded and the result is not shown to be.
    """
    if goal.bounded and len(form.axes) > MOST_AXES and form.margins is Form.margins:
        raise ValueError(f"bounded = True: no proof is known that would bound {form.name}")
    progress(f"exact {form.integral.symbol} where {form.name} is fitted")
    sample = sample_of(form, goal, weight)
    progress(f"{form.name}: least squares")
    starts = [start.ravel()] if start is not None else form.starts()
    if not starts:
        starts = _linear_starts(form, sample)
    found = _least_squares(form, sample, goal, starts)
    if goal.norm == "linf":
        progress(f"{form.name}: least largest error")
        found, sample = _least_largest(form, sample, goal, weight, found)
    if goal.rounding != "none":
        progress(f"{form.name}: rounding to {goal.rounding}")
        found = _rounded(form, sample, goal, found)
    progress(f"{form.name}: errors and certificate")
    fitted = form(jnp.asarray(found.reshape(np.shape(form.coefficient_names()))))
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
    on_grid = measure(form_values(fitted, sample.points) - sample.exact, sample.points, form)
    bound = None
    if goal.norm == "linf" and goal.side == "both" and np.all(sample.scale == 1):
        errors = form_values(fitted, sample.points) - sample.exact
        bound = lower_bound(form, sample.points, sample.exact, errors)
    return Fit(
        form=fitted,
        grid=sample,
        weight=weight,
        directions=0,
        solver="Levenberg–Marquardt (optimistix)"
        + ("; linear programs (HiGHS)" if goal.norm == "linf" else ""),
        reference_error=sample.error,
        on_grid=on_grid,
        off_grid=off_grid_errors(fitted),
        certificate=certificate,
        goal=goal,
        lower_bound=bound,
        range=values,
    )


def _problem(form: type[Form], sample: Sample, goal: Goal, fixed=None) -> Residuals:
    size = int(np.size(form.coefficient_names()))
    fixed = np.full(size, np.nan) if fixed is None else fixed
    return residuals(form, sample.points, sample.exact, sample.scale, fixed, goal.bounded)


def _linear_starts(form: type[Form], sample: Sample) -> list[np.ndarray]:
    """Give the last of a sequence of linear problems whose denominators stay positive."""
    parts = linear_parts(form, sample.points)
    if parts is None:
        raise ValueError(f"{form.name} has no starts: give one")
    a0, a, b0, b = parts
    denominator, found = b0, []
    for _ in range(LINEARISED):
        matrix = (a - sample.exact[:, None] * b) / denominator[:, None]
        z = np.linalg.lstsq(matrix, (sample.exact * b0 - a0) / denominator, rcond=None)[0]
        denominator = b0 + b @ z
        if denominator.min() <= 0:
            break
        found.append(z)
    if not found:
        raise ValueError(f"{form.name}: its linear problem has a pole; try other monomials")
    return found[-1:]


def _least_squares(form, sample: Sample, goal: Goal, starts: list[np.ndarray]) -> np.ndarray:
    shape = np.shape(form.coefficient_names())
    root = sample.scale / np.sqrt(len(sample.exact))

    def residual(z: Array) -> Array:
        fitted = form(z.reshape(shape))
        values = jax.vmap(lambda p: fitted(*p))(sample.points)
        short = PENALTY_FLOOR - jax.vmap(lambda p: fitted.positive(*p))(sample.points)
        penalty = jnp.maximum(short, 0) / np.sqrt(len(sample.exact))
        return jnp.concatenate([root * (values - sample.exact), penalty])

    steps = STEPS if len(starts[0]) <= MANY else STEPS_OF_MANY
    fit = jax.jit(lambda z: solve_nonlinear(residual, z, steps, rtol=1e-11, atol=1e-12))
    problem = _problem(form, sample, goal)
    ends = [np.asarray(fit(jnp.asarray(z))) if len(z) else z for z in starts]
    good = [z for z in ends if _is_good(problem, z)]
    if not good:
        raise ValueError(f"{form.name}: no start gives a form without poles")
    return min(good, key=lambda z: float(np.linalg.norm(problem.values(z))))


def _is_good(problem: Residuals, z: np.ndarray) -> bool:
    return bool(np.isfinite(problem.values(z)).all() and problem.positive(z).min() > 0)


def _least_largest(form, sample: Sample, goal: Goal, weight, start) -> tuple[np.ndarray, Sample]:
    """Minimise the largest error, with the worst points of elsewhere added in turn.

    Gives the coefficients whose largest error, elsewhere too, is least.
    """
    best, least, found = start, np.inf, start
    for turn in range(EXCHANGES if len(start) else 0):
        found = minimise_largest(_problem(form, sample, goal), found, goal.side)
        worst, size = _worst_elsewhere(form, found, goal, weight, SEED + 2 + turn)
        problem = _problem(form, sample, goal)
        known = badness(problem.values(found), *limits(problem, goal.side)).max()
        if max(known, size) < least:
            best, least = found, max(known, size)
        if size <= known * (1 + SETTLED):
            break
        sample = sample.extended(worst)
    return best, sample


def _worst_elsewhere(form, found: np.ndarray, goal: Goal, weight, seed: int):
    """Give the worst points of a finer set and what is found uphill from them, and how bad."""

    def size(points: np.ndarray, exact: np.ndarray) -> np.ndarray:
        scale = scale_at(points, exact, form, goal, weight)
        problem = _problem(form, Sample(points, exact, 0.0, scale), goal)
        return badness(problem.values(found), *limits(problem, goal.side))

    def size_at(points: np.ndarray) -> np.ndarray:
        return size(points, exact_values(form.integral, points))

    points, exact = check_reference(form, SEED + 2)
    sizes = size(points, exact)
    worst = points[np.argsort(-sizes)[:EXCHANGED]]
    if COUNTS[form.integral.name].climbs:
        worst = np.concatenate([worst, climb(size_at, points, sizes, form.axes, seed)])
    worst = sample_at(worst, form, goal, weight)
    return worst, float(size(worst.points, worst.exact).max())


def _rounded(form, sample: Sample, goal: Goal, found: np.ndarray) -> np.ndarray:
    """Round the coefficients, and refit those that are left after each turn."""
    dtype = PRECISIONS[goal.rounding]
    slopes = _problem(form, sample, goal).slopes(found, np.arange(len(sample.exact)))
    # What rounding one may do to the values: most first.
    order = np.argsort(-np.abs(found) * np.max(np.abs(slopes), axis=0, initial=0.0))
    fixed = np.full(len(found), np.nan)
    for turn in np.array_split(order, min(TURNS, max(len(order), 1))):
        fixed[turn] = found[turn].astype(dtype).astype(float)
        free = np.isnan(fixed)
        found = np.where(free, found, fixed)
        if free.any():
            problem = _problem(form, sample, goal, fixed)
            found[free] = _refitted(problem, found[free], goal)
    return found


def _refitted(problem: Residuals, start: np.ndarray, goal: Goal) -> np.ndarray:
    if goal.norm == "linf":
        return minimise_largest(problem, start, goal.side, programs=6)
    slopes = problem.slopes(start, np.arange(len(problem.values(start))))
    return start - np.linalg.lstsq(slopes, problem.values(start), rcond=None)[0]
