import numpy as np
import pytest

from fitting.paper import RationalG, RationalPs
from fitting.points.grids import (
    WEIGHTS,
    gauss_grid,
    light_directions,
    off_grid_points,
    trapezoid_grid,
)
from integrals import Axis

BOX = (
    Axis("x", "x", "1", -1.0, 2.0, "an axis"),
    Axis("y", "y", "rad", 0.5, 0.75, "another"),
)
ROUNDING = 1e-14


def mean(grid, function) -> float:
    return float(grid.weights @ function(*grid.points.T))


@pytest.mark.parametrize("make", [trapezoid_grid, gauss_grid])
def test_points_are_the_product_of_the_nodes_with_the_last_axis_fastest(make):
    grid = make(BOX, 5)
    assert grid.points.shape == (25, 2)
    np.testing.assert_array_equal(grid.points[:, 0], np.repeat(grid.nodes[0], 5))
    np.testing.assert_array_equal(grid.points[:, 1], np.tile(grid.nodes[1], 5))
    assert grid.weights.sum() == pytest.approx(1, abs=ROUNDING)
    assert (grid.weights > 0).all()


def test_the_uniform_grid_has_the_ends_and_averages_bilinear_functions_exactly():
    grid = trapezoid_grid(BOX, 7)
    for nodes, axis in zip(grid.nodes, BOX, strict=True):
        assert (nodes[0], nodes[-1]) == (axis.lower, axis.upper)
        np.testing.assert_allclose(np.diff(nodes), (axis.upper - axis.lower) / 6, rtol=1e-13)
    average = mean(grid, lambda x, y: 3 + 2 * x - y + x * y)
    assert average == pytest.approx(3 + 2 * 0.5 - 0.625 + 0.5 * 0.625, abs=ROUNDING)
    # A square is beyond the trapezoid rule: its error is (3/6)²/6.
    assert mean(grid, lambda x, y: x * x) - 1 == pytest.approx(0.25 / 6, abs=ROUNDING)


@pytest.mark.parametrize("count", [2, 5, 65])
def test_the_gauss_grid_averages_polynomials_of_degree_2n_minus_1_exactly(count):
    grid = gauss_grid(BOX, count)
    degree = 2 * count - 1
    for nodes, axis in zip(grid.nodes, BOX, strict=True):
        assert axis.lower < nodes[0] < nodes[-1] < axis.upper
    # the average of x^k over [−1, 2]
    exact = (2.0 ** (degree + 1) - (-1.0) ** (degree + 1)) / (3 * (degree + 1))
    assert mean(grid, lambda x, _: x**degree) == pytest.approx(exact, rel=1e-12)


def test_gauss_nodes_of_a_form_lie_in_its_domain():
    grid = gauss_grid(RationalG.axes, 129)
    for column, axis in zip(grid.points.T, RationalG.axes, strict=True):
        assert axis.contains(column).all()


# The averages of (cos θu, cos² θu, sin² θu cos² φ) over the hemisphere in each measure.
AVERAGES = {
    "uniform": (2 / np.pi, 1 / 2, 1 / 4),
    "solid-angle": (1 / 2, 1 / 3, 1 / 3),
    "cosine": (2 / 3, 1 / 2, 1 / 4),
}


@pytest.mark.parametrize("weight", WEIGHTS)
def test_light_directions_average_over_the_hemisphere_in_their_measure(weight):
    lights, weights = light_directions(RationalPs.axes[2], 16, weight)
    assert lights.shape == (256, 2)
    theta, phi = lights.T
    assert ((theta > 0) & (theta < np.pi / 2) & (phi > 0) & (phi < np.pi)).all()
    first, second, across = AVERAGES[weight]
    assert weights.sum() == pytest.approx(1, abs=ROUNDING)
    assert weights @ np.cos(theta) == pytest.approx(first, abs=ROUNDING)
    assert weights @ np.cos(theta) ** 2 == pytest.approx(second, abs=ROUNDING)
    assert weights @ (np.sin(theta) * np.cos(phi)) ** 2 == pytest.approx(across, abs=ROUNDING)
    assert weights @ (np.sin(theta) * np.cos(phi)) == pytest.approx(0, abs=ROUNDING)


def test_every_weight_has_its_average_in_this_table():
    assert set(AVERAGES) == set(WEIGHTS)


def test_off_grid_points_are_reproducible_fill_the_box_and_miss_every_grid():
    points = off_grid_points(BOX, 10, seed=3)
    assert points.shape == (1024, 2)
    np.testing.assert_array_equal(points, off_grid_points(BOX, 10, seed=3))
    assert not np.array_equal(points, off_grid_points(BOX, 10, seed=4))
    for column, axis in zip(points.T, BOX, strict=True):
        assert axis.contains(column).all()
        # a scrambled net of 2¹⁰ points has one in each of 2¹⁰ equal parts of every axis
        part = np.floor((column - axis.lower) / (axis.upper - axis.lower) * 1024)
        np.testing.assert_array_equal(np.sort(part), np.arange(1024))
    for make in (trapezoid_grid, gauss_grid):
        for column, nodes in zip(points.T, make(BOX, 65).nodes, strict=True):
            assert not np.isin(column, nodes).any()
