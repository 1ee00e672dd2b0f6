"""Where forms are fitted to a goal: points of their domain with exact values."""

import functools
from dataclasses import dataclass

import numpy as np

from fitting.errors import exact_estimates
from fitting.form import Form
from fitting.goal import LEAST_SQUARES, Goal
from fitting.points.grids import Weight, measure_of_lights
from fitting.points.scattered import COUNTS, spread_points
from integrals import INTEGRALS, Axis, Estimate

SEED = 20200819


@dataclass(frozen=True)
class Sample:
    """Points (n, axes), exact values (n,), a bound on the error of these, and `scale` (n,).

    `scale` is what errors are multiplied by before they are made small.
    """

    points: np.ndarray
    exact: np.ndarray
    error: float
    scale: np.ndarray

    def extended(self, other: "Sample") -> "Sample":
        """Give this with the points of another."""
        return Sample(
            np.concatenate([self.points, other.points]),
            np.concatenate([self.exact, other.exact]),
            max(self.error, other.error),
            np.concatenate([self.scale, other.scale]),
        )


def sample_of(form: type[Form], goal: Goal = LEAST_SQUARES, weight: Weight = "uniform") -> Sample:
    """Give the points that a form is fitted on; `weight` is the measure of lights of P_s."""
    name = form.integral.name
    points = spread_points(name, form.axes, COUNTS[name].fitted, SEED)
    return _sample(points, _estimates(name, form.axes), form, goal, weight)


def sample_at(points: np.ndarray, form: type[Form], goal: Goal, weight: Weight) -> Sample:
    """Give the sample of the same fit at other points."""
    return _sample(points, exact_estimates(form.integral, points), form, goal, weight)


def _sample(points: np.ndarray, estimates: Estimate, form, goal: Goal, weight: Weight) -> Sample:
    exact, error = np.asarray(estimates.value), float(np.max(estimates.error))
    return Sample(points, exact, error, scale_at(points, exact, form, goal, weight))


def scale_at(
    points: np.ndarray, exact: np.ndarray, form: type[Form], goal: Goal, weight: Weight
) -> np.ndarray:
    """Give what errors (n,) are multiplied by: a relative error's 1/|f|, and P_s's weight.

    Squares are multiplied by the measure's density; the largest error knows no measure, and is
    that of the light that arrives: with 'cosine' times cos θu, else as it is.
    """
    scale = 1 / np.abs(exact) if goal.relative else np.ones(len(exact))
    if form.integral.name != "ps":
        return scale
    theta_u = points[:, 2]
    if goal.norm == "l2":
        return scale * np.sqrt(measure_of_lights(theta_u, weight))
    return scale * np.cos(theta_u) if weight == "cosine" else scale


@functools.lru_cache(maxsize=16)
def _estimates(name: str, axes: tuple[Axis, ...]) -> Estimate:
    return exact_estimates(INTEGRALS[name], spread_points(name, axes, COUNTS[name].fitted, SEED))
