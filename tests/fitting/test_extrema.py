"""The search for the points with the largest errors."""

import numpy as np
import pytest

from fitting.solvers.extrema import worst_points
from integrals import Axis

LINE = (Axis("x", 0.0, 1.0),)
PLANE = (Axis("x", 0.0, 1.0), Axis("y", -1.0, 1.0))


def on_line(size) -> np.ndarray:
    points = np.linspace(0, 1, 65)[:, None]
    return np.sort(worst_points(size, points, size(points), LINE, 1)[:, 0])


def test_every_maximum_on_a_line_is_found():
    found = on_line(lambda x: np.abs(np.cos(9 * np.pi * x[:, 0])))
    # The sizes at the maxima are flat, so that rounding makes several of one.
    np.testing.assert_array_equal(np.unique(np.round(9 * found, 3)), np.arange(10))


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_oscillations_that_are_dense_at_an_end_are_found(end):
    def size(x):
        distance = np.abs(x[:, 0] - end)
        return np.abs(np.sin(np.log(distance + 1e-9)))

    found = np.abs(on_line(size) - end)
    # The sine is ±1 at ln(d + 1e-9) = −π/2 − kπ. The size is flat there.
    expected = np.exp(-np.pi / 2 - np.pi * np.arange(6)) - 1e-9
    for distance in expected:
        assert np.min(np.abs(found / distance - 1)) < 5e-3


def test_a_narrow_peak_between_the_nodes_is_climbed():
    # Its half width is a third of the distance of the nodes.
    found = on_line(lambda x: 0.1 + 1 / (1 + ((x[:, 0] - 0.30321) / 6e-4) ** 2))
    assert np.min(np.abs(found - 0.30321)) < 1e-6


def test_maxima_on_a_plane_are_found():
    def size(p):
        return np.abs(np.sin(2 * np.pi * p[:, 0]) * np.cos(np.pi * p[:, 1]))

    points = np.random.default_rng(2).uniform([0, -1], [1, 1], (4096, 2))
    found = worst_points(size, points, size(points), PLANE, 3)
    for x in (0.25, 0.75):
        for y in (-1, 0, 1):
            # Random steps end within 1e-3 of the domain, where a maximum is flat to 1e-4.
            near = np.abs(found - [x, y]).max(axis=1) < 0.02
            assert size(found[near]).max() > 1 - 1e-4
