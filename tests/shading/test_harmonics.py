"""Spherical harmonics are orthonormal, and their integrals over hemispheres are exact."""

import jax
import numpy as np

from integrals.rules.hemisphere import hemisphere_rule
from shading import (
    harmonics,
    irradiance,
    mean_radiance,
    radiance,
)


def test_harmonics_are_orthonormal_and_integrate_over_hemispheres():
    directions, weights = hemisphere_rule()
    values = np.asarray(jax.vmap(harmonics)(directions))
    # Y(−ω) = ±Y(ω) gives the integral over the other half of the sphere.
    sign = np.array([1, -1, -1, -1, 1, 1, 1, 1, 1])
    gram = np.einsum("n,ni,nj->ij", weights, values, values)
    np.testing.assert_allclose(gram + gram * np.outer(sign, sign), np.eye(9), atol=1e-12)
    rng = np.random.default_rng(5)
    light, rotation = rng.normal(size=9), np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turned = jax.vmap(radiance, (None, 0))(light, directions @ rotation.T)
    mean = weights @ turned / (2 * np.pi)
    total = weights @ (turned * directions[:, 2])
    np.testing.assert_allclose(mean_radiance(light, rotation[:, 2]), mean, atol=1e-12)
    np.testing.assert_allclose(irradiance(light, rotation[:, 2]), total, atol=1e-12)
