"""The lobe of one Gaussian as the building stone of profiles."""

import jax
import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import form_values
from integrals.skin import cylinder_scattering, ring_weights, sphere_scattering, sphere_weights
from quantities.skin.hyperbola_forms import MOST_WIDTH
from shading.skin import SKIN, GaussianProfile, burley_as_gaussians

COSINES = np.linspace(-1, 1, 41)
SURFACES = {
    "cylinder": (cylinder_scattering, ring_weights),
    "sphere": (sphere_scattering, sphere_weights),
}


def sum_of_lobes(surface, profile, curvature):
    """Return D (channels, cosines) by the table of a lobe, and the weight of lobes beyond it."""
    weights = np.asarray(SURFACES[surface][1](profile, curvature))
    widths = np.sqrt(profile.variances) * curvature
    fitted = resolve(f"best/skin-lobe-{surface}-63").require_fitted()
    lobes = [
        form_values(fitted, np.column_stack([COSINES, np.full(len(COSINES), min(s, MOST_WIDTH))]))
        for s in widths
    ]
    return weights @ np.array(lobes), weights[:, widths > MOST_WIDTH].sum(axis=1).max()


@pytest.mark.slow
@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("profile", [SKIN, burley_as_gaussians(0.7)], ids=["deon", "burley"])
def test_the_error_of_a_profile_is_at_most_that_of_a_lobe(surface, profile):
    largest = resolve(f"best/skin-lobe-{surface}-63").require_table().errors.off_grid.max
    exact = jax.jit(
        jax.vmap(lambda theta, k: SURFACES[surface][0](profile, theta, k), (0, None), 1)
    )
    for curvature in (0.02, 0.1, 0.3, 0.5):
        found, beyond = sum_of_lobes(surface, profile, curvature)
        error = np.abs(found - np.asarray(exact(np.arccos(COSINES), curvature))).max()
        # Lobes that are wider than the table's domain are clamped to it.
        assert error <= largest * (1 + 1e-3) + 0.2 * beyond
        assert 1e-5 < error < 0.002 + 0.2 * beyond


# Burley's profile for b = 0.7 mm, as the page has it
WIDTHS = (0.08, 0.162, 0.328, 0.663, 1.343, 2.717, 5.5)
WEIGHTS = (0.0372, 0.0881, 0.1447, 0.1865, 0.2723, 0.2322, 0.0390)


@pytest.mark.slow
def test_seven_lobes_are_burleys_profile():
    seven = GaussianProfile(tuple(s * s for s in WIDTHS), (WEIGHTS,))
    exact = jax.jit(
        jax.vmap(
            lambda theta, k: sphere_scattering(burley_as_gaussians(0.7), theta, k)[0], (0, None)
        )
    )
    errors = [
        np.abs(sum_of_lobes("sphere", seven, k)[0][0] - np.asarray(exact(np.arccos(COSINES), k)))
        for k in (0.02, 0.1, 0.3, 0.5)
    ]
    assert 0.0005 < np.max(errors) < 0.0018


def test_a_lobe_is_fitted_within_two_thousandths():
    for surface in SURFACES:
        table = resolve(f"best/skin-lobe-{surface}-63").require_table()
        assert table.certificates.least_error < table.errors.off_grid.max < 0.002
        assert table.size == 20
