"""The scattered points on which a form is fitted to a goal, with exact values and weights."""

import functools
from dataclasses import dataclass

import numpy as np

from fitting.form import Form
from fitting.goal import LEAST_SQUARES, Goal
from fitting.points.scattered import data_points, scattered_points
from integrals.reference import Axis, Estimate, Reference

SEED = 20200819
# The squares of larger values, and their sums, overflow.
_LARGEST = 1e150


@dataclass(frozen=True)
class Sample:
    """Points (n, axes) with their exact values (n,).

    `error` is a bound on the error of the exact values. The errors of a form are multiplied by
    `scale` (n,) before a fit minimises them.
    """

    points: np.ndarray
    exact: np.ndarray
    error: float
    scale: np.ndarray

    def extended(self, other: "Sample") -> "Sample":
        """Return this sample with the points of another one added."""
        return Sample(
            np.concatenate([self.points, other.points]),
            np.concatenate([self.exact, other.exact]),
            max(self.error, other.error),
            np.concatenate([self.scale, other.scale]),
        )


def sample_of(form: Form, goal: Goal = LEAST_SQUARES, measure: str = "uniform") -> Sample:
    """Return the sample on which a form is fitted; `measure` names a measure of the quantity.

    For least squares it has the points inside the domain only: those on faces are needed to find
    the largest error, but would weigh too much in a sum of squares.
    """
    reference = form.reference
    if reference.data is not None:
        return _sample_of_data(form, goal, measure)
    points = scattered_points(reference, form.axes, reference.sampling.fitted, SEED)
    estimates = _estimates(reference, form.axes)
    if goal.norm == "l2":
        inside = slice(2**reference.sampling.fitted)
        points, estimates = points[inside], Estimate(*(each[inside] for each in estimates))
    return _sample(points, estimates, form, goal, measure)


def _sample_of_data(form: Form, goal: Goal, measure: str) -> Sample:
    """Return the rows of the data that are not held out; least squares weighs them by 1/σ²."""
    data = form.reference.data
    assert data is not None
    points, values, weights = data_points(form, data.fitted)
    if len(points) < form.size:
        raise ValueError(
            f"{form.name} has {form.size} coefficients, but {data.source} has only {len(points)} "
            "rows to fit: allowed is a form with fewer"
        )
    _require_finite(points, values, form, goal)
    error = 0.0 if data.sigma is None else float(data.sigma.max())
    return Sample(points, values, error, scale_at(points, values, form, goal, measure) * weights)


def sample_at(points: np.ndarray, form: Form, goal: Goal, measure: str) -> Sample:
    """Return the sample of a fit at given points (n, axes)."""
    return _sample(points, form.reference.estimates(points), form, goal, measure)


def _sample(points: np.ndarray, estimates: Estimate, form, goal: Goal, measure: str) -> Sample:
    exact, error = np.asarray(estimates.value), np.asarray(estimates.error)
    _require_finite(points, exact, form, goal)
    scale = scale_at(points, exact, form, goal, measure)
    if form.reference.best_leg == "monte_carlo":
        # Values with a large standard error weigh less, as in a fit to data. Without the median, a
        # value whose error happens to be 0 would weigh more than all others.
        usual = np.median(error)
        scale = scale * (usual / np.hypot(usual, error) if usual > 0 else 1.0)
    return Sample(points, exact, float(np.max(error)), scale)


def _require_finite(points: np.ndarray, exact: np.ndarray, form: Form, goal: Goal) -> None:
    """Raise ValueError for exact values that no fit can be made to, with the first such point."""
    bad = ~(np.abs(exact) <= _LARGEST) | (goal.relative & (exact == 0))
    for k in np.flatnonzero(bad)[:1]:
        place = ", ".join(
            f"{axis.name} {x:.6g}" for axis, x in zip(form.axes, points[k], strict=True)
        )
        allowed = f"finite values up to {_LARGEST:g} in size"
        raise ValueError(
            f"{form.reference.name} is {exact[k]:g} at {place} and cannot be fitted there: "
            f"allowed are {allowed}{', but not 0, for relative errors' if goal.relative else ''}"
        )


def scale_at(
    points: np.ndarray, exact: np.ndarray, form: Form, goal: Goal, measure: str
) -> np.ndarray:
    """Return the numbers (n,) that the errors are multiplied by before they are minimised.

    Each is the product of two factors. The first is 1/|exact| if the goal is relative, and 1
    otherwise. The second comes from the measure: the square root of its `density` for least
    squares, and its `largest` for the largest error.
    """
    chosen = form.reference.sampling.measures[measure]
    scale = 1 / np.abs(exact) if goal.relative else np.ones(len(exact))
    factor = np.sqrt(chosen.density(points)) if goal.norm == "l2" else chosen.largest(points)
    return scale * factor


@functools.lru_cache(maxsize=16)
def _estimates(reference: Reference, axes: tuple[Axis, ...]) -> Estimate:
    points = scattered_points(reference, axes, reference.sampling.fitted, SEED)
    return reference.estimates(points)
