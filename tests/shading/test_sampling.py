"""Samples of the phase function follow its density, by a chi-square test over the sphere."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.stats import chi2

from shading import (
    direction,
    fiber_direction,
    fiber_root,
    phase_function,
    sample_phase_function,
)

# Probability that a correct sampler is rejected. The seed is fixed, so the result is reproducible.
REJECTION = 1e-4
COSINES, AZIMUTHS, POINTS = 16, 24, 60_000

_RNG = np.random.default_rng(1)
_GENERAL = np.linalg.qr(_RNG.normal(size=(3, 3)))[0] * _RNG.uniform(0.3, 1, 3)
ROOTS = {
    "fibre 0.3": np.asarray(fiber_root(fiber_direction(0.9), 0.3)),
    "fibre 0.8": np.asarray(fiber_root(fiber_direction(0.2), 0.8)),
    "general": _GENERAL,
}
LIGHTS = {"high": np.asarray(direction(0.4, 0.2)), "grazing": np.asarray(direction(1.55, 2.0))}

_sample = jax.jit(jax.vmap(sample_phase_function, (None, None, 0)))
_density = jax.jit(
    jax.vmap(lambda root, u, v: phase_function(root @ root.T, u, v), (None, None, 0))
)


def p_value(views, density) -> float:
    """Return the p-value: the probability that views of this density deviate more than these.

    The bins are equal in cos θ and φ. Expected counts are integrals by 12² Gauss points.
    """
    x, weights = np.polynomial.legendre.leggauss(12)
    x, weights = (x + 1) / 2, weights / 2
    cosine = ((np.arange(COSINES)[:, None] + x) / COSINES).ravel() * 2 - 1
    azimuth = ((np.arange(AZIMUTHS)[:, None] + x) / AZIMUTHS).ravel() * 2 * np.pi - np.pi
    c, phi = (a.ravel() for a in np.meshgrid(cosine, azimuth, indexing="ij"))
    s = np.sqrt(1 - c * c)
    at = np.stack([s * np.cos(phi), s * np.sin(phi), c], axis=1)
    values = np.reshape(density(at), (COSINES, 12, AZIMUTHS, 12))
    cell = 4 * np.pi / COSINES / AZIMUTHS
    expected = np.einsum("aibj,i,j->ab", values, weights, weights) * cell
    assert abs(expected.sum() - 1) < 2e-3
    expected *= len(views) / expected.sum()
    counts, _, _ = np.histogram2d(
        views[:, 2],
        np.arctan2(views[:, 1], views[:, 0]),
        [np.linspace(-1, 1, COSINES + 1), np.linspace(-np.pi, np.pi, AZIMUTHS + 1)],
    )
    full = expected > 10
    statistic = np.sum((counts[full] - expected[full]) ** 2 / expected[full])
    return chi2.sf(statistic, full.sum() - 1)


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("name", ROOTS)
def test_samples_follow_the_phase_function(name, light):
    root, u = ROOTS[name], LIGHTS[light]
    views = np.asarray(_sample(root, u, np.random.default_rng(7).random((POINTS, 2))))
    np.testing.assert_allclose(np.linalg.norm(views, axis=1), 1, rtol=1e-13)
    assert p_value(views, lambda v: _density(root, u, v)) > REJECTION


def test_a_wrong_density_is_rejected():
    u, points = LIGHTS["high"], np.random.default_rng(7).random((POINTS, 2))
    views = np.asarray(_sample(fiber_root(fiber_direction(0.9), 0.33), u, points))
    assert p_value(views, lambda v: _density(ROOTS["fibre 0.3"], u, v)) < 1e-9
    sides = np.asarray(_sample(ROOTS["fibre 0.3"], LIGHTS["grazing"], points))
    assert p_value(sides, lambda v: _density(ROOTS["fibre 0.3"], u, v)) < 1e-9


def test_samples_are_differentiable_with_respect_to_the_light():
    light = jnp.asarray(LIGHTS["high"])
    moved = jax.jit(jax.jacfwd(lambda u: sample_phase_function(_GENERAL, u, jnp.array([0.3, 0.7]))))
    assert np.isfinite(moved(light)).all()
