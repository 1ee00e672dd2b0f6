"""Smoothing against the sum over all pairs, and the drift against the gradient of curvature."""

import jax
import numpy as np
import pytest

from shadefit.curvature import curvature, mesh
from shadefit.curvature.gaussian_sums import REACH, blocks, in_plane
from shadefit.curvature.generators import cylinder, ellipsoid, finger, torus
from shadefit.curvature.smoothing import normal_drift, smoothed, smoothed_with_drift
from shadefit.curvature.surfaces import Torus, normals_and_tensors
from shadefit.curvature.tensors import space_tensors
from shading.curvature import carried

EGG = ellipsoid((20.0, 10.0, 7.0), 3)


def all_pairs(made, found, width):
    """Return the smoothed tensors by the sum over all vertices, a pair at a time."""
    matrices = space_tensors(found.tensors, found.frames)
    result = np.empty_like(found.tensors)
    for k, (place, normal) in enumerate(zip(made.vertices, made.normals, strict=True)):
        distance2 = np.sum((made.vertices - place) ** 2, axis=1)
        counts = (distance2 <= (REACH * width) ** 2) & (made.normals @ normal > 0)
        weight = found.areas * np.exp(-distance2 / (2 * width**2)) * counts
        frames = np.broadcast_to(found.frames[k], (len(matrices), 2, 3))
        normals = np.broadcast_to(normal, (len(matrices), 3))
        moved = in_plane(matrices, made.normals, frames, normals)
        result[k] = weight @ moved / weight.sum()
    return result


def test_tensors_are_carried_by_the_shortest_rotation():
    found = curvature(EGG)
    matrices = space_tensors(found.tensors, found.frames)
    moved = in_plane(matrices[:9], EGG.normals[:9], found.frames[9:18], EGG.normals[9:18])
    frames = (found.frames[:9], found.frames[9:18])
    expected = jax.jit(jax.vmap(carried))(found.tensors[:9], *frames)
    np.testing.assert_allclose(moved, expected, atol=1e-15)


def test_smoothing_is_the_sum_over_all_pairs():
    found = curvature(EGG)
    expected = all_pairs(EGG, found, 3.0)
    # Cells so small that each vertex is a sample of its own
    np.testing.assert_allclose(smoothed(EGG, found, [3.0], 1e-4).tensors, expected, atol=1e-14)
    error = np.abs(smoothed(EGG, found, [3.0]).tensors - expected)
    assert error.max() < 3e-4


def test_copies_of_a_vertex_do_not_change_smoothing():
    corners = EGG.triangles.ravel()
    split = mesh(
        EGG.vertices[corners],
        np.arange(len(corners)).reshape(-1, 3),
        EGG.normals[corners],
        unit="mm",
    )
    whole, parts = curvature(EGG), curvature(split)
    expected = smoothed(EGG, whole, [3.0]).tensors[corners]
    np.testing.assert_allclose(smoothed(split, parts, [3.0]).tensors, expected, atol=1e-14)
    found = normal_drift(split, parts)
    both = smoothed_with_drift(split, parts)
    np.testing.assert_array_equal(both[0].tensors, smoothed(split, parts, [1.4]).tensors)
    np.testing.assert_array_equal(both[1], found)
    np.testing.assert_allclose(found, normal_drift(EGG, whole)[corners], atol=1e-14)


def test_vertices_without_area_keep_their_tensors_and_have_no_drift():
    places = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [90, 0, 0], [91, 0, 0], [92, 0, 0]])
    made = mesh(places, np.array([[0, 1, 2], [3, 4, 5]]), unit="mm")
    found = curvature(made)
    assert np.all(smoothed(made, found).tensors[3:] == found.tensors[3:])
    assert np.abs(normal_drift(made, found)).max() < 1e-15
    empty = mesh(places[3:], np.array([[0, 1, 2]]), unit="mm")
    assert np.all(smoothed(empty, curvature(empty)).tensors == 0)


def test_drift_is_half_the_gradient_of_the_trace_also_on_uneven_meshes():
    """A Gaussian of 1.4 mm on a torus with cells of about 1 mm has the error of the next order."""
    surface = Torus(15.0, 6.0)
    step = 1e-4
    for jitter, largest in ((0.0, 0.02), (0.3, 0.04)):
        made = torus(15.0, 6.0, 96, 40, jitter)
        found = curvature(made)
        expected = np.empty((len(made.vertices), 2))
        for k in range(2):
            ends = [made.vertices + side * step * found.frames[:, k] for side in (1, -1)]
            traces = [np.trace(normals_and_tensors(surface, e)[1], 0, 1, 2) for e in ends]
            expected[:, k] = (traces[0] - traces[1]) / (4 * step)
        error = normal_drift(made, found) - expected
        assert np.sqrt(np.mean(error**2) / np.mean(expected**2)) < largest


def test_drift_is_zero_on_cylinders_with_ends_and_marks_the_seam_of_a_finger():
    made = cylinder(7.0, 30.0, 48, 32)
    assert np.abs(normal_drift(made, curvature(made))).max() < 1e-3
    capsule = finger(7.0, 20.0, 48)
    found = curvature(capsule)
    drift = np.einsum("na,nai->ni", normal_drift(capsule, found), found.frames)[:, 0]
    at_seam = np.abs(np.abs(capsule.vertices[:, 0]) - 20.0) < 1e-9
    # On the plane, where the normal's slope jumps by 1/r, its mean leans by σ/(r √(2π)).
    expected = 1 / (7 * np.sqrt(2 * np.pi) * 1.4)
    towards = np.sign(capsule.vertices[at_seam, 0]) * drift[at_seam]
    np.testing.assert_allclose(towards, expected, rtol=0.08)
    far = np.abs(capsule.vertices[:, 0]) < 12
    assert np.abs(drift[far]).max() < 1e-5


def test_blocks_have_every_point_once():
    found = list(blocks(EGG.vertices, 50))
    assert max(map(len, found)) <= 50
    np.testing.assert_array_equal(np.sort(np.concatenate(found)), np.arange(len(EGG.vertices)))
    assert [len(each) for each in blocks(np.zeros((7, 3)), 3)] != []


@pytest.mark.parametrize("value", [0.0, -1.0, np.inf, np.nan])
def test_widths_and_cells_that_are_not_positive_are_refused(value):
    found = curvature(EGG)
    with pytest.raises(ValueError, match="widths = "):
        smoothed(EGG, found, [value])
    with pytest.raises(ValueError, match="cell = "):
        normal_drift(EGG, found, cell=value)
