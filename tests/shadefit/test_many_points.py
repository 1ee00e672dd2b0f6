"""Values at many points: of quantities, references and fitted forms, in any shape."""

import numpy as np
import pytest

import shadefit as sf
from fitting.points.grids import sobol_points
from shadefit import many_points


def test_values_are_those_of_each_point_in_the_shape_of_the_points():
    points = sobol_points(sf.load("best/q-9").axes, 4, 1).reshape(2, 8, 1)
    found = sf.estimates(sf.Q, points)
    assert found.value.shape == found.error.shape == (2, 8)
    np.testing.assert_array_equal(sf.values(sf.problem("q"), points), found.value)
    np.testing.assert_array_equal(found.value.ravel(), sf.Q.values(points.reshape(-1, 1)))
    fitted = sf.load("best/q-9")
    one = np.array([float(fitted(x)) for (x,) in points.reshape(-1, 1)])
    np.testing.assert_allclose(sf.values(fitted, points).ravel(), one, rtol=1e-15)


def test_chunks_do_not_change_values(monkeypatch):
    points = np.linspace(0, 0.5, 11)[:, None]
    expected = [sf.values(each, points) for each in (sf.Q, sf.load("q"))]
    monkeypatch.setattr(many_points, "_CHUNK", 4)
    for each, values in zip((sf.Q, sf.load("q")), expected, strict=True):
        np.testing.assert_array_equal(sf.values(each, points), values)
        assert sf.values(each, np.zeros((0, 1))).shape == (0,)


def test_outside_the_domain_there_is_no_value():
    points = np.array([[-0.1], [0.2], [0.6]])
    for each in (sf.load("q"), sf.Q):
        assert np.isnan(sf.values(each, points)).tolist()[:2] == [True, False]
    assert np.isnan(sf.values(sf.load("q"), points)[2])


@pytest.mark.parametrize("points", [np.array(0.5), np.array([0.1, 0.2]), np.zeros((3, 2))])
def test_points_of_another_number_of_arguments_are_refused(points):
    for each in (sf.load("q"), sf.Q):
        with pytest.raises(
            ValueError, match=r"points of shape .*: allowed are \(…, 1\), of density"
        ):
            sf.values(each, points)


def test_complex_points_are_refused():
    with pytest.raises(ValueError, match="complex points: allowed are real numbers"):
        sf.values(sf.Q, np.array([[1j]]))
