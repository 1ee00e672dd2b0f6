"""Directions of light: their cosines, and rules that average over the hemisphere."""

import jax
import numpy as np
import pytest

from fitting.points.grids import sobol_points
from integrals.fuzz.ps import MEASURES
from quantities.fuzz.lights import cosines_at, cosines_of_light, light_directions
from quantities.fuzz.supplement import RATIONAL_PS

ROUNDING = 1e-14
# The averages of (cos θu, cos² θu, sin² θu cos² φ) over the hemisphere in each measure.
AVERAGES = {
    "uniform": (2 / np.pi, 1 / 2, 1 / 4),
    "solid-angle": (1 / 2, 1 / 3, 1 / 3),
    "cosine": (2 / 3, 1 / 2, 1 / 4),
}


@pytest.mark.parametrize("measure", MEASURES)
def test_lights_average_over_the_hemisphere_in_their_measure(measure):
    lights, weights = light_directions(16, measure)
    assert lights.shape == (256, 2)
    theta, phi = lights.T
    assert ((theta > 0) & (theta < np.pi / 2) & (phi > 0) & (phi < np.pi)).all()
    first, second, across = AVERAGES[measure]
    assert weights.sum() == pytest.approx(1, abs=ROUNDING)
    assert weights @ np.cos(theta) == pytest.approx(first, abs=ROUNDING)
    assert weights @ np.cos(theta) ** 2 == pytest.approx(second, abs=ROUNDING)
    assert weights @ (np.sin(theta) * np.cos(phi)) ** 2 == pytest.approx(across, abs=ROUNDING)
    assert weights @ (np.sin(theta) * np.cos(phi)) == pytest.approx(0, abs=ROUNDING)


def test_every_measure_has_its_averages_here():
    assert set(AVERAGES) == set(MEASURES)


def test_cosines_in_numpy_and_in_jax_are_dot_products_of_unit_vectors():
    points = sobol_points(RATIONAL_PS.axes, 6, seed=1)
    _, theta_f, theta_u, phi = points.T
    fibre = np.stack([np.sin(theta_f), 0 * theta_f, np.cos(theta_f)])
    light = np.stack(
        [np.sin(theta_u) * np.cos(phi), np.sin(theta_u) * np.sin(phi), np.cos(theta_u)]
    )
    un, ut, nt = cosines_at(points)
    np.testing.assert_allclose(un, light[2], atol=ROUNDING)
    np.testing.assert_allclose(ut, (light * fibre).sum(axis=0), atol=ROUNDING)
    np.testing.assert_allclose(nt, fibre[2], atol=ROUNDING)
    in_jax = jax.vmap(cosines_of_light)(*points.T)
    np.testing.assert_allclose(in_jax, [un, ut], atol=ROUNDING)
