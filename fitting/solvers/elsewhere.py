"""Where a form has larger errors than at the points of a fit."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fitting.form import FittedForm, Form
from fitting.goal import Goal
from fitting.points.sample import SEED, Sample, sample_at, scale_at
from fitting.points.scattered import checking_points
from fitting.solvers.extrema import worst_points
from fitting.solvers.residuals import Residuals, badness, limits, residuals

# Returns points (m, axes) of a form's domain at which its absolute error is above a level, or none
# (0, axes) if it finds none.
Counterexamples = Callable[[FittedForm, float], np.ndarray]


@dataclass(frozen=True)
class Elsewhere:
    """The errors of a form with some coefficients outside the sample of a fit.

    An error that the goal does not allow counts as much larger (`badness`).
    """

    form: Form
    found: np.ndarray
    goal: Goal
    measure: str
    seed: int

    def size(self, points: np.ndarray, exact: np.ndarray) -> np.ndarray:
        """Return the sizes (n,) of the errors at points (n, axes)."""
        scale = scale_at(points, exact, self.form, self.goal, self.measure)
        problem = problem_at(self.form, Sample(points, exact, 0.0, scale), self.goal)
        return badness(problem.values(self.found), *limits(problem, self.goal.side))

    def worst(self, count: int, known: Sample, sizes: np.ndarray) -> tuple[Sample, float]:
        """Return the points with the largest errors, and the largest error.

        They are `count` of a finer set of points, and what a search for local maxima finds. It
        starts there and at the points `known` of the fit, whose errors are `sizes` (n,).
        """
        points, exact = checking_points(self.form, SEED + 2)
        fine = self.size(points, exact)
        worst = points[np.argsort(-fine)[:count]]
        sampling = self.form.reference.sampling
        if sampling.climbs or sampling.refined:
            starts, heights = np.concatenate([points, known.points]), np.concatenate([fine, sizes])
            worst = np.concatenate([worst, self._maxima(starts, heights)])
        added = sample_at(worst, self.form, self.goal, self.measure)
        return added, float(self.size(added.points, added.exact).max())

    def uphill(self, points: np.ndarray) -> Sample:
        """Return points (n, axes), and the local maxima that a search finds from there."""
        exact = self.form.reference.values(points)
        top = self._maxima(points, self.size(points, exact))
        return sample_at(np.concatenate([points, top]), self.form, self.goal, self.measure)

    def _maxima(self, points: np.ndarray, sizes: np.ndarray) -> np.ndarray:
        def size_at(points: np.ndarray) -> np.ndarray:
            return self.size(points, self.form.reference.values(points))

        sampling = self.form.reference.sampling
        steps = None if sampling.climbs else sampling.refined
        return worst_points(size_at, points, sizes, self.form.axes, self.seed, steps)


def problem_at(
    form: Form,
    sample: Sample,
    goal: Goal,
    free: np.ndarray | None = None,
    fixed: np.ndarray | None = None,
) -> Residuals:
    """Return the residuals at a sample as functions of the free coefficients; by default of all.

    `free`, a mask, and `fixed`, the values of the others, have an element for each coefficient.
    """
    free = np.full(form.size, True) if free is None else free.copy()
    fixed = np.zeros(form.size) if fixed is None else fixed.copy()
    return residuals(form, sample.points, sample.exact, sample.scale, free, fixed, goal.bounded)
