"""Tensor grids and their weights, and scrambled Sobol' points."""

import numpy as np
import pytest

from fitting.points.grids import gauss_grid, sobol_points, trapezoid_grid, unit_points
from integrals import Axis
from quantities.fuzz.supplement import RATIONAL_G

BOX = (
    Axis("x", -1.0, 2.0, meaning="an axis"),
    Axis("y", 0.5, 0.75, "y", "rad", "another"),
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
    # The trapezoid rule is not exact for a square: its error is (3/6)²/6.
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
    grid = gauss_grid(RATIONAL_G.axes, 129)
    for column, axis in zip(grid.points.T, RATIONAL_G.axes, strict=True):
        assert axis.contains(column).all()


def test_sobol_points_are_reproducible_fill_the_box_and_are_on_no_grid():
    points = sobol_points(BOX, 10, seed=3)
    assert points.shape == (1024, 2)
    np.testing.assert_array_equal(points, sobol_points(BOX, 10, seed=3))
    assert not np.array_equal(points, sobol_points(BOX, 10, seed=4))
    for column, axis in zip(points.T, BOX, strict=True):
        assert axis.contains(column).all()
        # A scrambled net of 2¹⁰ points has one in each of 2¹⁰ equal parts of every axis.
        part = np.floor((column - axis.lower) / (axis.upper - axis.lower) * 1024)
        np.testing.assert_array_equal(np.sort(part), np.arange(1024))
    for make in (trapezoid_grid, gauss_grid):
        for column, nodes in zip(points.T, make(BOX, 65).nodes, strict=True):
            assert not np.isin(column, nodes).any()


def test_unit_points_are_the_sobol_points_of_the_unit_cube():
    unit = unit_points(2, 6, seed=9)
    assert unit.shape == (64, 2)
    assert ((unit >= 0) & (unit < 1)).all()
    lower, width = np.array([-1.0, 0.5]), np.array([3.0, 0.25])
    np.testing.assert_array_equal(sobol_points(BOX, 6, seed=9), lower + width * unit)
