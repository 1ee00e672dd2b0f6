"""Brute-force diffusion: exact on a sphere, judged by another rule, and κ_eff is the best."""

import numpy as np
import pytest

from shadefit.curvature.comparison import METHODS, SURFACES, errors, lit, on_sphere
from shadefit.curvature.diffusion import patch
from shadefit.curvature.surfaces import Ellipsoid, Torus


def test_the_nodes_have_the_area_of_the_surface():
    ball = patch(Ellipsoid((3.0, 3.0, 3.0)), np.array([0.0, 0, 3.0]), 6)
    np.testing.assert_allclose(ball.areas.sum(), 36 * np.pi, rtol=1e-10)
    ring = patch(Torus(15.0, 6.0), np.array([21.0, 0, 0]), 6)
    np.testing.assert_allclose(ring.areas.sum(), 4 * np.pi**2 * 90, rtol=1e-10)


@pytest.mark.slow
def test_the_effective_curvature_has_the_least_error():
    """At random points and lights; on sphere and torus it has about half of the error, or less.

    The ratio on the sphere is 0.49 to 0.50, depending on the draw: 0.52 leaves room for that.
    """
    for name, surface in SURFACES.items():
        seen = lit(surface, 150, 5)
        rms = {key: np.sqrt(np.mean(each[:, 0] ** 2)) for key, each in errors(seen).items()}
        assert min(rms, key=rms.__getitem__) == "effective", name
        bound = {"sphere 10": 0.52, "torus 15, 6": 0.5}.get(name, 1.0)
        assert rms["effective"] <= bound * rms["along the light"], name
        if name == "sphere 10":
            assert np.abs(on_sphere(10.0, seen) - seen.values).max() < 4e-5
    assert set(METHODS) == set(rms)
