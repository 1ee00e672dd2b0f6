"""Where forms are fitted to a goal: points of their domain with exact values."""

import functools
from dataclasses import dataclass

import numpy as np

from fitting.errors import exact_estimates
from fitting.form import Form
from fitting.spread import spread_points
from integrals import INTEGRALS, Axis

# log₂ of the number of points inside; half as many are on the faces, as many about the fibre.
SIZES = {"ps": 13, "g": 13, "q": 11, "r": 11, "norm": 11}
SEED = 20200819


@dataclass(frozen=True)
class Sample:
    """Points (n, axes), exact values (n,), and a bound on the error of these."""

    points: np.ndarray
    exact: np.ndarray
    error: float


def sample_of(form: type[Form]) -> Sample:
    """Give the points that a form is fitted on."""
    return _sample(form.integral.name, form.axes)


@functools.lru_cache(maxsize=16)
def _sample(name: str, axes: tuple[Axis, ...]) -> Sample:
    points = spread_points(name, axes, SIZES[name], SEED)
    estimates = exact_estimates(INTEGRALS[name], points)
    return Sample(points, np.asarray(estimates.value), float(np.max(estimates.error)))
