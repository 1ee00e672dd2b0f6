"""Fits to scattered points: least squares from several starts, exchange, and rounding.

1. Least squares: the best result of several starts is kept.
2. If the goal's norm is 'linf', linear programs minimise the largest error at the points of the
   sample. The points outside the sample that have the largest errors are then added to it, and the
   step is repeated. This is called exchange.
3. If the goal has a rounding, the coefficients are rounded in groups, those whose rounding changes
   the values most first. After each group, the coefficients that are not yet rounded are refitted.
"""

from dataclasses import dataclass, field

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.errors import climb
from fitting.form import Form
from fitting.goal import Goal
from fitting.linearity import linear_parts, positive_of
from fitting.points.sample import SEED, Sample, sample_at, sample_of, scale_at
from fitting.points.scattered import checking_points
from fitting.solvers.least_squares import solve_nonlinear
from fitting.solvers.minimax import Minimax, Residuals, badness, limits, residuals
from fitting.solvers.on_grid import Progress

PRECISIONS = {"float32": np.float32, "float16": np.float16}


@dataclass(frozen=True)
class Exchange:
    """The solver of fits to scattered points, with its tuning constants.

    * `steps`: the most steps of least squares. A form with more than `many` coefficients takes at
      most `steps_of_many`, because each of its steps is slow.
    * `penalty_floor`: in least squares, a penalty applies where the number that must stay positive
      is below this.
    * `linearised`: the number of linear fits that compute a start for a quotient. Each divides the
      errors by the denominator of the fit before.
    * `exchanges`, `exchanged`, `settled`: at most `exchanges` times, up to `exchanged` points with
      the largest errors outside the sample are added to it, and those that hill climbing finds. The
      exchange ends when their largest error exceeds that of the sample by at most the fraction
      `settled`.
    * `turns`: the number of groups in which the coefficients are rounded.
    * `minimax`: minimises the largest error. `minimax_of_rounding` does so after each group is
      rounded.
    """

    steps: int = 1000
    steps_of_many: int = 200
    many: int = 20
    penalty_floor: float = 1e-2
    linearised: int = 8
    exchanges: int = 8
    exchanged: int = 300
    settled: float = 1e-3
    turns: int = 4
    minimax: Minimax = field(default_factory=Minimax)
    minimax_of_rounding: Minimax = field(default_factory=lambda: Minimax(programs=6))

    def fit(
        self, form: Form, goal: Goal, measure: str, start: np.ndarray | None, progress: Progress
    ) -> tuple[np.ndarray, Sample]:
        """Return flat coefficients, and the sample on which they were fitted.

        `start`, flat coefficients, replaces the form's own starts. `progress` is called with a text
        before each step. Raises ValueError if no start leads to a form without poles.
        """
        progress(f"exact {form.reference.symbol} where {form.name} is fitted")
        sample = sample_of(form, goal, measure)
        progress(f"{form.name}: least squares")
        starts = [start] if start is not None else list(form.starts)
        if not starts:
            starts = [self._linear_start(form, sample)]
        found = self._least_squares(form, sample, goal, starts)
        if goal.norm == "linf":
            progress(f"{form.name}: least largest error")
            found, sample = self._least_largest(form, sample, goal, measure, found)
        if goal.rounding != "none":
            progress(f"{form.name}: rounding to {goal.rounding}")
            found = self._rounded(form, sample, goal, found)
        return found, sample

    def _linear_start(self, form: Form, sample: Sample) -> np.ndarray:
        """Return the coefficients of the last of the linear fits with positive denominators.

        Raises ValueError for a form that is no quotient of linear functions, and if the first fit
        already has a denominator that is not positive.
        """
        parts = linear_parts(form, sample.points)
        if parts is None:
            raise ValueError(f"{form.name} has no starts: give one")
        denominator, found = parts.b0, None
        for _ in range(self.linearised):
            matrix = (parts.a - sample.exact[:, None] * parts.b) / denominator[:, None]
            values = (sample.exact * parts.b0 - parts.a0) / denominator
            z = np.linalg.lstsq(matrix, values, rcond=None)[0]
            denominator = parts.b0 + parts.b @ z
            if denominator.min() <= 0:
                break
            found = z
        if found is None:
            raise ValueError(f"{form.name}: its linear problem has a pole; try other monomials")
        return found

    def _least_squares(
        self, form: Form, sample: Sample, goal: Goal, starts: list[np.ndarray]
    ) -> np.ndarray:
        root, positive = sample.scale / np.sqrt(len(sample.exact)), positive_of(form)

        def residual(z: Array) -> Array:
            c = z.reshape(form.coefficient_shape)
            values = jax.vmap(lambda p: form(c, *p))(sample.points)
            short = self.penalty_floor - jax.vmap(lambda p: positive(c, *p))(sample.points)
            penalty = jnp.maximum(short, 0) / np.sqrt(len(sample.exact))
            return jnp.concatenate([root * (values - sample.exact), penalty])

        steps = self.steps if len(starts[0]) <= self.many else self.steps_of_many
        fit = jax.jit(lambda z: solve_nonlinear(residual, z, steps, rtol=1e-11, atol=1e-12))
        problem = _problem(form, sample, goal)
        ends = [np.asarray(fit(jnp.asarray(z))) if len(z) else z for z in starts]
        good = [z for z in ends if _is_good(problem, z)]
        if not good:
            raise ValueError(f"{form.name}: no start gives a form without poles")
        return min(good, key=lambda z: float(np.linalg.norm(problem.values(z))))

    def _least_largest(
        self, form: Form, sample: Sample, goal: Goal, measure: str, start: np.ndarray
    ) -> tuple[np.ndarray, Sample]:
        """Minimise the largest error, adding points with larger errors to the sample in turn.

        Returns the coefficients with the least largest error, inside and outside the sample, and
        the extended sample.
        """
        best, least, found = start, np.inf, start
        for turn in range(self.exchanges if len(start) else 0):
            problem = _problem(form, sample, goal)
            found = self.minimax(problem, found, goal.side)
            worst, size = self._worst_elsewhere(form, found, goal, measure, SEED + 2 + turn)
            known = badness(problem.values(found), *limits(problem, goal.side)).max()
            if max(known, size) < least:
                best, least = found, max(known, size)
            if size <= known * (1 + self.settled):
                break
            sample = sample.extended(worst)
        return best, sample

    def _worst_elsewhere(self, form: Form, found: np.ndarray, goal: Goal, measure: str, seed: int):
        """Return the points outside the sample with the largest errors, and the largest error.

        They come from a finer set of points, and from hill climbing that starts there. An error
        that the goal does not allow counts as much larger (`badness`).
        """

        def size(points: np.ndarray, exact: np.ndarray) -> np.ndarray:
            scale = scale_at(points, exact, form, goal, measure)
            problem = _problem(form, Sample(points, exact, 0.0, scale), goal)
            return badness(problem.values(found), *limits(problem, goal.side))

        def size_at(points: np.ndarray) -> np.ndarray:
            return size(points, form.reference.values(points))

        points, exact = checking_points(form, SEED + 2)
        sizes = size(points, exact)
        worst = points[np.argsort(-sizes)[: self.exchanged]]
        if form.reference.sampling.climbs:
            worst = np.concatenate([worst, climb(size_at, points, sizes, form.axes, seed)])
        added = sample_at(worst, form, goal, measure)
        return added, float(size(added.points, added.exact).max())

    def _rounded(self, form: Form, sample: Sample, goal: Goal, found: np.ndarray) -> np.ndarray:
        """Round the coefficients in groups. After each, refit those that are not yet rounded."""
        dtype = PRECISIONS[goal.rounding]
        slopes = _problem(form, sample, goal).slopes(found, np.arange(len(sample.exact)))
        # The coefficients whose rounding may change the values most come first.
        order = np.argsort(-np.abs(found) * np.max(np.abs(slopes), axis=0, initial=0.0))
        free, found = np.full(len(found), True), found.copy()
        for turn in np.array_split(order, min(self.turns, max(len(order), 1))):
            found[turn] = found[turn].astype(dtype).astype(float)
            free[turn] = False
            if free.any():
                problem = _problem(form, sample, goal, free, found)
                found[free] = self._refitted(problem, found[free], goal)
        return found

    def _refitted(self, problem: Residuals, start: np.ndarray, goal: Goal) -> np.ndarray:
        if goal.norm == "linf":
            return self.minimax_of_rounding(problem, start, goal.side)
        slopes = problem.slopes(start, np.arange(len(problem.values(start))))
        return start - np.linalg.lstsq(slopes, problem.values(start), rcond=None)[0]


def _problem(
    form: Form,
    sample: Sample,
    goal: Goal,
    free: np.ndarray | None = None,
    fixed: np.ndarray | None = None,
) -> Residuals:
    """Return the residuals as functions of the free coefficients; by default all are free."""
    free = np.full(form.size, True) if free is None else free.copy()
    fixed = np.zeros(form.size) if fixed is None else fixed.copy()
    return residuals(form, sample.points, sample.exact, sample.scale, free, fixed, goal.bounded)


def _is_good(problem: Residuals, z: np.ndarray) -> bool:
    return bool(np.isfinite(problem.values(z)).all() and problem.positive(z).min() > 0)
