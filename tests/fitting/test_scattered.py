"""Points where forms are fitted, checked and judged, with exact values."""

import numpy as np
import pytest

from fitting import Domain
from fitting.points.grids import gauss_grid, sobol_points, trapezoid_grid
from fitting.points.scattered import checking_points, judging_points, scattered_points
from integrals import REFERENCES
from integrals.reference import box_of
from quantities import problem, problems
from quantities.fuzz.supplement import RATIONAL_G, RATIONAL_PS, RATIONAL_R

DEFAULTS = {name: each.default for name, each in problems().items()}


@pytest.mark.parametrize("name", REFERENCES)
def test_scattered_points_are_in_the_closed_domain_and_reproducible(name):
    form = DEFAULTS[name]
    points = scattered_points(form.reference, form.axes, 7, seed=5)
    lower, upper = box_of(form.axes).T
    inside, width = (points[:, : len(lower)] >= lower) & (points <= upper), upper - lower
    if name == "ps":
        # P_s is periodic in the azimuth: lights near the fibre have those from −π to π.
        inside[:, 3] = np.abs(points[:, 3]) <= 2 * np.pi
        width[3] = np.inf
    assert inside.all()
    assert (np.ptp(points, axis=0) > 0.9 * np.where(np.isinf(width), 0, width)).all()
    again = scattered_points(form.reference, form.axes, 7, seed=5)
    np.testing.assert_array_equal(points, again)
    assert not np.array_equal(points, scattered_points(form.reference, form.axes, 7, seed=6))


@pytest.mark.parametrize("name", REFERENCES)
def test_half_as_many_points_again_are_stretched_and_many_of_them_are_on_faces(name):
    form = DEFAULTS[name]
    points = scattered_points(form.reference, form.axes, 8, seed=5)
    own, extra = 256 + 128, form.reference.sampling.extra
    assert len(points) == (own if extra is None else own + len(extra(points[:own])))
    lower, upper = box_of(form.axes).T
    on_face = ((points[:own] == lower) | (points[:own] == upper)).any(axis=1)
    assert not on_face[:256].any()
    # A coordinate is clipped with probability 0.2.
    expected = 1 - 0.8 ** len(form.axes)
    assert np.mean(on_face[256:]) == pytest.approx(expected, abs=0.1)


def test_points_follow_the_scale_of_an_axis():
    """G's axes are logarithmic or square: more points are near the lower end."""
    points = scattered_points(RATIONAL_G.reference, RATIONAL_G.axes, 10, seed=2)[:1024]
    for column, axis in zip(points.T, RATIONAL_G.axes, strict=True):
        middle = axis.place(np.array([0.5]))[0]
        assert np.mean(column < middle) == pytest.approx(0.5, abs=0.01)


def test_the_points_that_judge_are_fixed_and_on_no_grid():
    points, exact = judging_points(RATIONAL_G)
    assert points.shape == (2**16, 2)
    again = sobol_points(RATIONAL_G.axes, 16, seed=20200717)
    np.testing.assert_array_equal(points, again)
    first = RATIONAL_G.reference.values(points[:64])
    np.testing.assert_allclose(exact[:64], first, rtol=1e-14)
    for make in (trapezoid_grid, gauss_grid):
        for column, nodes in zip(points.T, make(RATIONAL_G.axes, 65).nodes, strict=True):
            assert not np.isin(column, nodes).any()


def test_enough_points_judge_that_the_largest_error_is_nearly_found():
    for each in REFERENCES.values():
        # Along one axis, half as many are as dense as 2²² over two.
        assert each.sampling.judged >= (11 if len(each.axes) == 1 else 12)
    assert len(judging_points(RATIONAL_R)[0]) == 2**12


def test_points_are_those_of_the_domain_that_is_judged():
    part = Domain(problem("q").reference, (DEFAULTS["q"].axes[0],))
    np.testing.assert_array_equal(judging_points(part)[0], judging_points(DEFAULTS["q"])[0])
    for one, other in zip(checking_points(part, 3), checking_points(DEFAULTS["q"], 3), strict=True):
        np.testing.assert_array_equal(one, other)


def test_exact_values_belong_to_the_points_that_check():
    points, exact = checking_points(RATIONAL_G, 77)
    np.testing.assert_allclose(exact[::997], RATIONAL_G.reference.values(points[::997]), rtol=1e-14)
    other, _ = checking_points(RATIONAL_G, 78)
    assert points.shape == other.shape
    assert not np.array_equal(points, other)


def test_points_of_p_s_include_lights_near_the_fibre():
    points = scattered_points(RATIONAL_PS.reference, RATIONAL_PS.axes, 8, seed=4)
    alpha, theta_f, theta_u, phi = points.T
    cosine = np.sin(theta_f) * np.sin(theta_u) * np.cos(phi) + np.cos(theta_f) * np.cos(theta_u)
    near = np.arccos(np.clip(cosine, -1, 1)) < 5 * alpha
    # The second half is made of the first by moving lights.
    assert near[len(points) // 2 :].mean() > near[: len(points) // 2].mean() + 0.1
