"""Tensors of meshes: exact on spheres and cylinders, of second order, and judged by libigl."""

import numpy as np
import pytest

from shadefit.curvature import curvature, in_frames, mesh
from shadefit.curvature.generators import (
    cylinder,
    ellipsoid,
    exact_tensors,
    finger,
    icosphere,
    torus,
)
from shadefit.curvature.surfaces import Ellipsoid, Finger, Torus
from shadefit.curvature.tensors import space_tensors

SPHERE, RING, EGG = Ellipsoid((7.0, 7.0, 7.0)), Torus(15.0, 6.0), Ellipsoid((20.0, 10.0, 7.0))


def errors(surface, made):
    """Return the rms and the largest relative error of the vertices' tensors."""
    found = curvature(made)
    exact = exact_tensors(surface, made.vertices)
    wrong = np.linalg.norm(space_tensors(found.tensors, found.frames) - exact, axis=(1, 2))
    relative = wrong / np.linalg.norm(exact, axis=(1, 2))
    return np.sqrt(np.mean(relative**2)), relative.max()


def without_normals(made):
    return mesh(made.vertices, made.triangles, unit="mm")


@pytest.mark.parametrize("level", [0, 3])
def test_a_sphere_is_exact(level):
    assert errors(SPHERE, icosphere(7.0, level))[1] < 1e-14
    # The weights of Max are exact on a sphere; short edges enlarge their rounding.
    assert errors(SPHERE, without_normals(icosphere(7.0, level)))[1] < 1e-13


def test_a_cylinder_is_exact():
    assert errors(Finger(7.0, 20.0), cylinder(7.0, 40.0, 32, 20))[1] < 1e-14


def test_a_finger_is_exact_away_from_where_its_curvature_jumps():
    made, surface = finger(7.0, 20.0, 32), Finger(7.0, 20.0)
    found = curvature(made)
    wrong = space_tensors(found.tensors, found.frames) - exact_tensors(surface, made.vertices)
    away = np.abs(np.abs(made.vertices[:, 0]) - 20.0) > 2.0
    assert away.sum() > 500
    assert np.abs(wrong[away]).max() < 1e-14


def test_a_regular_torus_is_of_second_order():
    coarse = errors(RING, torus(15.0, 6.0, 48, 24))[0]
    fine = errors(RING, torus(15.0, 6.0, 96, 48))[0]
    assert coarse < 7.8e-3
    assert 1.9 < np.log2(coarse / fine) < 2.1


def test_a_moved_torus_is_of_first_order_with_exact_normals_and_of_none_without():
    coarse, fine = (torus(15.0, 6.0, 48 * k, 24 * k, 0.3) for k in (1, 4))
    assert 0.8 < np.log2(errors(RING, coarse)[0] / errors(RING, fine)[0]) / 2 < 1.3
    made = [errors(RING, without_normals(each))[0] for each in (coarse, fine)]
    assert made[1] > 0.6 * made[0]


def test_an_ellipsoid_converges():
    found = [errors(EGG, ellipsoid(EGG.axes, level))[0] for level in (3, 4)]
    assert found[0] < 0.014 and found[0] / found[1] > 3


def test_libigl_agrees_and_converges_to_the_same():
    igl = pytest.importorskip("igl")
    made = ellipsoid(EGG.axes, 4)
    found = curvature(made)
    values = np.linalg.eigvalsh(found.tensors[:, [[0, 1], [1, 2]]])
    results = igl.principal_curvature(made.vertices, made.triangles)
    theirs = np.sort(np.stack(results[2:4], 1), axis=1)
    difference = np.sqrt(np.mean((values - theirs) ** 2) / np.mean(theirs**2))
    # Their quadric patches differ by 3.7 % here; our error is 0.4 %.
    assert difference < 0.045
    exact = np.linalg.eigvalsh(exact_tensors(EGG, made.vertices))
    exact = np.sort(exact, axis=1)[:, 1:]
    ours, other = (np.sqrt(np.mean((each - exact) ** 2)) for each in (values, theirs))
    assert ours < other


def test_seams_and_turned_triangles_do_not_change_tensors():
    made = icosphere(7.0, 2)
    whole = curvature(made)
    corners = made.triangles.ravel()
    split = mesh(
        made.vertices[corners],
        np.arange(len(corners)).reshape(-1, 3)[:, [0, 2, 1]],
        made.normals[corners],
        unit="mm",
    )
    found = curvature(split)
    np.testing.assert_allclose(found.tensors, whole.tensors[corners], atol=1e-15)
    np.testing.assert_allclose(found.areas, whole.areas[corners], rtol=1e-13)


def test_units_are_converted_and_frames_are_exchanged():
    made = icosphere(7.0, 1)
    metres = mesh(made.vertices / 1000, made.triangles, made.normals, unit="m")
    np.testing.assert_allclose(curvature(metres).tensors[:, 0], 1 / 7, rtol=1e-12)
    found = curvature(cylinder(5.0, 20.0, 24, 4))
    along = in_frames(found, np.tile([1.0, 0, 0], (len(found.tensors), 1)))
    expected = np.tile([0, 0, 0.2], (len(found.tensors), 1))
    np.testing.assert_allclose(along.tensors, expected, atol=1e-15)
    with pytest.raises(ValueError, match=r"tangent 0 is .*: allowed are directions"):
        in_frames(found, np.zeros((len(found.tensors), 3)))


def test_what_is_not_sound_is_counted():
    places = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [9, 9, 9], [2, 0, 0], [0, -1, 0]]
    triangles = [[0, 1, 2], [0, 1, 3], [0, 1, 6], [0, 1, 5]]
    made = mesh(np.array(places), np.array(triangles), unit="cm")
    assert made.made_normals == 7
    found = curvature(made)
    assert (found.degenerate, found.isolated, found.non_manifold) == (1, 2, 1)
    assert np.isfinite(found.tensors).all() and np.all(found.tensors[[4, 5]] == 0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"unit": "furlong"}, "unit 'furlong' is not known: allowed are mm"),
        ({"vertices": [[0.0, 0, np.nan], [1, 0, 0], [0, 1, 0]]}, "vertex 0 is .*, and 0 more"),
        ({"vertices": [[0.0, 0, 1e300], [1, 0, 0], [0, 1, 0]]}, "finite numbers up to 1e12"),
        ({"triangles": [[0, 1, 3]]}, "triangles: allowed are whole numbers from 0 to 2"),
        ({"triangles": [[0.0, 1, 2]]}, "triangles: allowed are whole numbers"),
        ({"triangles": np.zeros((0, 3), int)}, r"triangles have the shape \(0, 3\)"),
        ({"normals": np.zeros((2, 3))}, r"normals have the shape \(2, 3\)"),
    ],
)
def test_bad_meshes_are_refused_in_a_line(change, message):
    given = {"vertices": np.eye(3), "triangles": np.array([[0, 1, 2]]), "unit": "mm"} | change
    with pytest.raises(ValueError, match=message):
        mesh(
            np.array(given["vertices"]),
            np.array(given["triangles"]),
            given.get("normals"),
            unit=given["unit"],
        )


def test_normals_that_are_no_directions_are_made_and_counted():
    made = icosphere(7.0, 1)
    broken = made.normals.copy()
    broken[0], broken[1] = np.nan, 0.0
    again = mesh(made.vertices, made.triangles, broken, unit="mm")
    assert again.made_normals == 2
    np.testing.assert_allclose(again.normals, made.normals, atol=1e-14)
