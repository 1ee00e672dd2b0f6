"""The rasteriser, the picture of a mesh as skin, and the packaged picture of skin on surfaces."""

import numpy as np
import pytest

from shadefit.curvature.generators import icosphere, torus
from shadefit.curvature.mesh_picture import axes_of
from shadefit.curvature.raster import rasterise
from shadefit.curvature.skin_light import SHADERS, Skin
from shadefit.figures.skin_surfaces import shaded

RANDOM = np.random.default_rng(4)


def every_pair(places, triangles, size):
    """Return the number of the nearest triangle by looking at each triangle at each pixel."""
    found, nearest = np.full(size, -1), np.full(size, -np.inf)
    for y in range(size[0]):
        for x in range(size[1]):
            for k, (a, b, c) in enumerate(places[triangles]):
                matrix = np.array([[a[0], b[0], c[0]], [a[1], b[1], c[1]], [1, 1, 1]])
                weights = np.linalg.solve(matrix, [x + 0.5, y + 0.5, 1])
                depth = weights @ [a[2], b[2], c[2]]
                if weights.min() >= 0 and depth > nearest[y, x]:
                    found[y, x], nearest[y, x] = k, depth
    return found


def test_each_pixel_has_its_nearest_triangle_and_its_weights():
    places = RANDOM.uniform(-5, 20, (30, 3))
    triangles = RANDOM.permutation(30).reshape(10, 3)
    raster = rasterise(places, triangles, (12, 15))
    np.testing.assert_array_equal(raster.triangles, every_pair(places, triangles, (12, 15)))
    corners, weights = raster.corners(triangles)
    points = np.einsum("pk,pki->pi", weights, places[corners])
    y, x = np.nonzero(raster.covered)
    np.testing.assert_allclose(points[:, :2], np.stack([x, y], 1) + 0.5, atol=1e-11)


def test_large_and_degenerate_triangles_and_those_beyond_the_image(monkeypatch):
    monkeypatch.setattr("shadefit.curvature.raster._PAIRS", 10)
    places = np.array([[-99.0, -99, 0], [999, -99, 0], [-99, 999, 0], [5, 5, 9], [-50, -60, 1]])
    triangles = np.array([[3, 3, 4], [0, 4, 4], [0, 1, 2], [2, 1, 0], [4, 4, 4]])
    raster = rasterise(places, triangles, (6, 7))
    assert np.all(raster.triangles == 2)
    np.testing.assert_allclose(raster.weights.sum(-1), 1.0)
    assert not rasterise(places, triangles[:1], (6, 7)).covered.any()
    assert not rasterise(places - 9999, triangles, (6, 7)).covered.any()


def test_the_area_of_a_sphere_is_that_of_its_disc():
    made = icosphere(40.0, 4)
    raster = rasterise(made.vertices + 50, made.triangles, (100, 100))
    assert abs(raster.covered.sum() / (np.pi * 1600) - 1) < 0.01
    corners, weights = raster.corners(made.triangles)
    depth = np.einsum("pk,pk->p", weights, made.vertices[corners][..., 2])
    assert depth.min() > -1.0


def test_the_viewer_is_at_plus_z_and_y_is_up():
    np.testing.assert_allclose(axes_of(0.0, 0.0), np.eye(3), atol=1e-15)
    right, up, out = axes_of(np.pi / 2, 0.0)
    np.testing.assert_allclose([right, up, out], [[0, 0, -1], [0, 1, 0], [1, 0, 0]], atol=1e-15)
    turned = axes_of(0.7, -0.4)
    np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(turned) > 0


def test_points_between_vertices_have_unit_normals_and_mean_tensors():
    made = torus(15.0, 6.0, 12, 8)
    count = len(made.vertices)
    zero = np.zeros((count, 3, 3))
    skin = Skin(made.normals, RANDOM.normal(size=(count, 3, 3)), zero, 0 * made.normals)
    corners = made.triangles[:5]
    found = skin.at(corners, np.tile([0.5, 0.25, 0.25], (5, 1)))
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1.0)
    expected = skin.tensors[corners[:, 0]] / 2 + skin.tensors[corners[:, 1:]].sum(1) / 4
    np.testing.assert_allclose(found.tensors, expected, rtol=1e-14)
    across = np.array([[1.0, 0, 0], [-1, 0, 0], [1, 0, 0]])
    opposite = Skin(across, zero[:3], zero[:3], 0 * across)
    weights = np.array([[0.5, 0.5, 0.0]])
    np.testing.assert_array_equal(opposite.at(np.array([[0, 1, 2]]), weights).normals, [[0, 0, 1]])


@pytest.mark.slow
def test_looks_agree_with_lambert_on_a_plane_and_the_equivalent_cylinder_is_nearest():
    """The picture at a quarter of its pixels has the order of errors that its caption says."""
    count = 40
    heights = np.linspace(-1, 1, count)
    normals = np.column_stack([np.sqrt(1 - heights**2), 0 * heights, heights])
    zero = np.zeros((count, 3, 3))
    flat = Skin(normals, zero, zero, np.zeros((count, 3)))
    light = np.array([0.0, 0, 1])
    for name, shader in SHADERS.items():
        # Between texels the table rounds the kink off, and it has 8 bits.
        tolerance = 5e-3 if name.startswith("LUT") else 1e-7
        expected = np.repeat(np.maximum(heights, 0)[:, None], 3, axis=1)
        np.testing.assert_allclose(shader(flat, light), expected, atol=tolerance, err_msg=name)
    found = shaded(0.6, 2)
    truth = found.images["truth"]
    rms = [
        np.sqrt(np.mean((found.images[name] - truth)[found.covered][:, 0] ** 2)) for name in SHADERS
    ]
    assert np.all(np.diff(rms) < 0)
    assert rms[3] < 0.3 * rms[1]
    assert found.covered.mean() > 0.3
