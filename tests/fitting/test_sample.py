"""Where fits are made, and what their errors are multiplied by."""

import numpy as np
import pytest

from fitting import Goal
from fitting.points.grids import sobol_points
from fitting.points.sample import SEED, sample_at, sample_of, scale_at
from fitting.points.scattered import scattered_points
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G, RATIONAL_PS

POINTS = sobol_points(RATIONAL_PS.axes, 6, seed=3)
THETA = POINTS[:, 2]
EXACT = np.linspace(0.1, 0.9, len(POINTS))


@pytest.mark.parametrize(
    ("goal", "measure", "expected"),
    [
        (Goal(), "uniform", np.ones_like(THETA)),
        (Goal(), "solid-angle", np.sqrt(np.sin(THETA))),
        (Goal(), "cosine", np.sqrt(np.sin(THETA) * np.cos(THETA))),
        (Goal("linf"), "solid-angle", np.ones_like(THETA)),
        (Goal("linf"), "cosine", np.cos(THETA)),
        (Goal("linf", relative=True), "cosine", np.cos(THETA) / EXACT),
    ],
)
def test_errors_are_scaled_by_the_measure_and_the_value(goal, measure, expected):
    found = scale_at(POINTS, EXACT, RATIONAL_PS, goal, measure)
    np.testing.assert_allclose(found, expected, rtol=1e-15)


def test_the_uniform_measure_weighs_all_errors_alike():
    np.testing.assert_array_equal(sample_of(QUADRATIC_Q, Goal(), "uniform").scale, 1)


def test_the_sample_of_a_form_is_the_scattered_points_of_its_quantity():
    found, reference = sample_of(RATIONAL_G, Goal("linf")), RATIONAL_G.reference
    points = scattered_points(reference, RATIONAL_G.axes, reference.sampling.fitted, SEED)
    np.testing.assert_array_equal(found.points, points)
    np.testing.assert_array_equal(found.exact, reference.values(points))
    # Those on faces would weigh too much in a sum of squares.
    inside = points[: 2**reference.sampling.fitted]
    np.testing.assert_array_equal(sample_of(RATIONAL_G).points, inside)
    assert 0 < found.error < 1e-12


def test_a_sample_is_extended_by_points_elsewhere():
    goal = Goal("linf", relative=True)
    first = sample_of(QUADRATIC_Q, goal)
    points = np.array([[0.1], [0.37]])
    other = sample_at(points, QUADRATIC_Q, goal, "uniform")
    np.testing.assert_allclose(other.scale, 1 / QUADRATIC_Q.reference.values(points))
    both = first.extended(other)
    np.testing.assert_array_equal(both.points, np.concatenate([first.points, points]))
    np.testing.assert_array_equal(both.exact, np.concatenate([first.exact, other.exact]))
    np.testing.assert_array_equal(both.scale, np.concatenate([first.scale, other.scale]))
    assert both.error == max(first.error, other.error)
