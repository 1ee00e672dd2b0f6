"""Brute-force diffusion: exact on a sphere, judged by another rule, and κ_eff is the best."""

import numpy as np
import pytest

from shadefit.curvature.comparison import (
    METHODS,
    SURFACES,
    errors,
    lit,
    lit_at,
    on_sphere,
    shaded,
)
from shadefit.curvature.diffusion import patch
from shadefit.curvature.surfaces import (
    Ellipsoid,
    Finger,
    RoundedFinger,
    Torus,
    random_points,
)

BLURRED = "equivalent cylinder, blurred, with drift"


def test_the_nodes_have_the_area_of_the_surface():
    ball = patch(Ellipsoid((3.0, 3.0, 3.0)), np.array([0.0, 0, 3.0]), 6)
    np.testing.assert_allclose(ball.areas.sum(), 36 * np.pi, rtol=1e-10)
    ring = patch(Torus(15.0, 6.0), np.array([21.0, 0, 0]), 6)
    np.testing.assert_allclose(ring.areas.sum(), 4 * np.pi**2 * 90, rtol=1e-10)

    capsule = patch(Finger(7.0, 25.0), np.array([26.0, np.sqrt(48.0), 0]), 6)
    np.testing.assert_allclose(capsule.areas.sum(), 14 * np.pi * (14 + 50), rtol=1e-10)
    # A rounded finger has no simple area, but any two points must see the same.
    finger = RoundedFinger(7.0, 32.0)
    areas = [patch(finger, point, 6).areas.sum() for point in random_points(finger, 2, 1)]
    np.testing.assert_allclose(areas[0], areas[1], rtol=1e-5)


@pytest.mark.parametrize("surface", [Finger(7.0, 25.0), RoundedFinger(7.0, 32.0)])
def test_random_points_are_on_the_finger_and_uniform(surface):
    points = random_points(surface, 4000, 2)
    if isinstance(surface, Finger):
        beyond = np.abs(points[:, 0]) > 25
        axis = np.clip(points[:, 0], -25, 25)
        distance = np.hypot(points[:, 0] - axis, np.hypot(points[:, 1], points[:, 2]))
        np.testing.assert_allclose(distance, 7.0, rtol=1e-14)
        # The caps have 14 of 64 parts of the area; 4 standard errors are 0.026.
        assert abs(beyond.mean() - 14 / 64) < 0.026
    else:
        x, y, z = points.T
        np.testing.assert_allclose((x / 32) ** 4 + (y * y + z * z) / 49, 1.0, rtol=1e-12)
    turn = np.arctan2(points[:, 2], points[:, 1])
    assert abs(np.mean(np.exp(1j * turn))) < 4 / np.sqrt(4000)


def test_the_equivalent_cylinder_is_nearest_on_a_finger():
    """At the seam of the capsule, where curvature jumps, the drift is what is missing."""
    surface = Finger(7.0, 25.0)
    points = np.array([[25.5, 0, np.sqrt(48.75)], [24.0, 7, 0], [0, 0, 7]])
    lights = np.array([[0.6, 0, 0.8], [-0.6, 0.64, 0.48], [0.8, 0.6, 0]])
    seen = lit_at(surface, points, lights, 4)
    names = ("along the light", "equivalent cylinder", BLURRED)
    found = {name: np.abs(shaded(name, seen) - seen.values)[:, 0] for name in names}
    # On the cylinder, far from the caps, it is exact but for the error of the brute force.
    assert found["equivalent cylinder"][2] < 2e-4
    assert found["along the light"][2] > 5e-3
    assert np.all(found[BLURRED][:2] < 0.4 * found["along the light"][:2])


@pytest.mark.slow
def test_the_equivalent_cylinder_has_about_half_of_the_error_of_curvature_along_the_light():
    """At random points and lights of all surfaces; on the sphere it has a tenth."""
    for name, surface in SURFACES.items():
        seen = lit(surface, 100, 5, 4)
        rms = {key: np.sqrt(np.mean(each[:, 0] ** 2)) for key, each in errors(seen).items()}
        best = rms[BLURRED]
        # On the sphere there is no drift, and blurring changes nothing but the rounding.
        assert best <= min(rms.values()) * (1 + 1e-9), name
        # At 600 points it is 0.45 to 0.48 on the ellipsoid 12, 8, 5, depending on the draw, and
        # less on the others. At 100 points it was 0.40 to 0.51, of which 0.51 is that of this draw.
        assert best <= 0.55 * rms["along the light"], name
        assert rms["effective"] < rms["along the light"], name
        if name == "sphere 10":
            cosines = np.sum(seen.normals * seen.lights, axis=1)
            assert np.abs(on_sphere(10.0, cosines) - seen.values).max() < 1e-4
    assert set(METHODS) == set(rms)
