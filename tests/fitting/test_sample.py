"""Where fits are made, and what their errors are multiplied by."""

import numpy as np
import pytest

from fitting import Goal, improve
from fitting.errors import form_values, off_grid_reference
from fitting.families.ps import one_root_ps
from fitting.paper import QuadraticQ, RationalPs
from fitting.points.grids import off_grid_points
from fitting.points.sample import sample_of, scale_at

POINTS = off_grid_points(RationalPs.axes, 6, seed=3)
THETA = POINTS[:, 2]
EXACT = np.linspace(0.1, 0.9, len(POINTS))


@pytest.mark.parametrize(
    ("goal", "weight", "expected"),
    [
        (Goal(), "uniform", np.ones_like(THETA)),
        (Goal(), "solid-angle", np.sqrt(np.sin(THETA))),
        (Goal(), "cosine", np.sqrt(np.sin(THETA) * np.cos(THETA))),
        (Goal("linf"), "solid-angle", np.ones_like(THETA)),
        (Goal("linf"), "cosine", np.cos(THETA)),
        (Goal("linf", relative=True), "cosine", np.cos(THETA) / EXACT),
    ],
)
def test_errors_are_scaled_by_the_measure_and_the_value(goal, weight, expected):
    found = scale_at(POINTS, EXACT, RationalPs, goal, weight)
    np.testing.assert_allclose(found, expected, rtol=1e-15)


def test_quantities_without_a_light_have_no_weight():
    plain, weighted = (sample_of(QuadraticQ, Goal(), weight) for weight in ("uniform", "cosine"))
    np.testing.assert_array_equal(plain.scale, weighted.scale)
    np.testing.assert_array_equal(plain.scale, 1)


@pytest.mark.slow
def test_a_weight_lowers_the_weighted_error():
    form = one_root_ps(skew=0, degree=1, least_alpha=0.15)
    points, exact = off_grid_reference(form)
    density = np.sin(points[:, 2]) * np.cos(points[:, 2])

    def rms(weight):
        difference = form_values(improve(form, Goal(), weight=weight).form, points) - exact
        return np.sqrt(np.average(difference**2, weights=density))

    assert rms("cosine") < 0.99 * rms("uniform")
