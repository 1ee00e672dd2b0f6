"""Light on curved skin: independent legs, printed anchors, and what is known exactly."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals.skin import (
    cylinder_scattering,
    ring_lobe,
    ring_weights,
    sphere_lobe,
    sphere_scattering,
)
from integrals.skin.harmonics import burley_harmonics, harmonic_factors, lobe_harmonics
from integrals.skin.lobe_series import ring_series, sphere_series
from integrals.skin.sampling import ring_by_sampling, sphere_by_sampling
from shading.skin import PENNER_WIDENED, SKIN, burley_as_gaussians

THETA = jnp.linspace(0, np.pi, 21)
LOBES = {"ring": ring_lobe, "sphere": sphere_lobe}


def over(function, *fixed):
    return np.asarray(jax.jit(jax.vmap(lambda t: function(t, *fixed)))(THETA))


@pytest.mark.parametrize("surface", ["ring", "sphere"])
def test_quadrature_and_series_agree(surface):
    """0.08/30 is the narrowest Gaussian of skin at r = 30 mm; the sum has 5,000 terms there."""
    series = {"ring": ring_series, "sphere": sphere_series}[surface]
    allowed = {"ring": 1e-13, "sphere": 1e-11}[surface]

    @jax.jit
    def difference(width):
        lobe = LOBES[surface]
        return jax.vmap(lambda t: lobe(t, width) - series(t, width))(THETA)

    for width in (0.08 / 30, 0.03, 0.5, 2.7, 30.0):
        assert float(jnp.abs(difference(width)).max()) < allowed


@pytest.mark.slow
@pytest.mark.parametrize("surface", ["ring", "sphere"])
def test_random_points_agree(surface):
    sampling = {"ring": ring_by_sampling, "sphere": sphere_by_sampling}[surface]
    for width in (0.05, 0.6):
        estimate = jax.vmap(lambda t, s=width: sampling(t, s))(THETA)
        # Opposite the light no point may be lit: the true value is far below this.
        allowed = 5 * np.asarray(estimate.error) + 1e-5
        assert np.all(np.abs(np.asarray(estimate.value) - over(LOBES[surface], width)) < allowed)


def test_pesces_printed_numbers():
    """Pesce's notebook of 2011 prints these for red at θ = 0.1, with variances times √2."""
    found = [float(cylinder_scattering(PENNER_WIDENED, 0.1, 1 / r)[0]) for r in (8, 15)]
    np.testing.assert_allclose(found, [0.979266, 0.990641], atol=5e-7)


def test_pesces_printed_sums():
    """The same by his rule of 20 steps, whose error is 0.012: it has the terms of the integral."""
    found = []
    for r in (8, 15):
        x = -np.pi + np.arange(20 + 1) * 2 * np.pi / 20
        v, w = np.array(PENNER_WIDENED.variances), np.array(PENNER_WIDENED.weights[0])
        chord = 2 * r * np.sin(x / 2)
        weight = (w * np.exp(-(chord[:, None] ** 2) / (2 * v)) / np.sqrt(2 * np.pi * v)).sum(axis=1)
        found.append((weight * np.maximum(np.cos(0.1 + x), 0)).sum() / weight.sum())
    np.testing.assert_allclose(found, [0.990889, 0.994601], atol=5e-7)


@pytest.mark.parametrize("surface", ["ring", "sphere"])
def test_the_odd_part_and_the_mean_are_known(surface):
    """D(θ) − D(π − θ) is a multiple of cos θ; the mean over the surface is that of the light."""
    lobe = jax.jit(jax.vmap(LOBES[surface], (0, None)))
    for width in (0.01, 0.4, 3.0):
        check_odd_part_and_mean(surface, lobe, width)


def check_odd_part_and_mean(surface, lobe, width):
    found = np.asarray(lobe(THETA, width))
    z = 1 / width**2
    first = {
        "ring": float(jax.scipy.special.i1e(z) / jax.scipy.special.i0e(z)),
        "sphere": float(lobe_harmonics(width)[0]),
    }[surface]
    np.testing.assert_allclose(found - found[::-1], first * np.cos(THETA), atol=1e-13)
    # By Gauss–Legendre quadrature, graded to the kink that narrow Gaussians have nearly
    x, weights = np.polynomial.legendre.leggauss(80)
    half = np.pi / 4 * (1 + x) ** 3 / 4
    theta = np.concatenate([np.pi / 2 - half, np.pi / 2 + half])
    weights = np.tile(weights * np.pi / 4 * 3 * (1 + x) ** 2 / 4, 2)
    values = np.asarray(lobe(theta, width))
    mean = weights @ (values if surface == "ring" else values * np.sin(theta) / 2)
    expected = 1.0 if surface == "ring" else 0.25
    assert mean == pytest.approx(expected, abs=1e-12)


def test_flat_skin_shows_the_cosine_and_small_surfaces_show_the_mean():
    for lobe, mean in ((ring_lobe, 1 / np.pi), (sphere_lobe, 0.25)):
        at = jax.jit(jax.vmap(lobe, (0, None)))
        np.testing.assert_allclose(at(THETA, 0.0), np.maximum(np.cos(THETA), 0), atol=1e-11)
        np.testing.assert_allclose(at(THETA, 1e4), mean, atol=1e-7)


def test_the_curvature_of_a_ring_drives_the_second_derivative():
    """D″ + D is the Gaussian at the two terminators."""
    s, h = 0.5, 1e-3
    for theta in (0.3, 1.4, 2.5):
        below, at, above = (float(ring_lobe(theta + d, s)) for d in (-h, 0, h))

        def density(x):
            z = 1 / s**2
            return float(
                jnp.exp(-2 * jnp.sin(x / 2) ** 2 * z) / (2 * np.pi * jax.scipy.special.i0e(z))
            )

        expected = density(theta - np.pi / 2) + density(theta + np.pi / 2)
        assert (above - 2 * at + below) / h**2 + at == pytest.approx(expected, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("scattering", [cylinder_scattering, sphere_scattering])
def test_derivatives_are_finite_and_right(scattering):
    def red(theta, curvature):
        return scattering(SKIN, theta, curvature)[0]

    derivatives = jax.jit(jax.grad(red, (0, 1)))
    value = jax.jit(red)
    for theta in (0.0, 1.0, np.pi / 2, np.pi):
        for curvature in (1e-12, 1e-3, 0.2, 3.0, 1e3):
            found = [float(each) for each in derivatives(theta, curvature)]
            assert np.isfinite(found).all()
            h, k = 1e-5, 1e-5 * curvature
            turned = (value(theta + h, curvature) - value(theta - h, curvature)) / (2 * h)
            if 0 < theta < np.pi:
                assert found[0] == pytest.approx(
                    float(turned), abs=1e-7 + 1e-3 * (curvature < 1e-9)
                )
            if curvature > 1e-9:
                bent = (value(theta, curvature + k) - value(theta, curvature - k)) / (2 * k)
                assert found[1] == pytest.approx(float(bent), rel=1e-6, abs=1e-6)


def test_the_radial_profile_loses_light_beside_a_ring():
    """The weights of the wide Gaussians of red fall."""
    linear, radial = (np.asarray(ring_weights(SKIN, 0.1, radial=each))[0] for each in (False, True))
    assert linear[4] + linear[5] > 0.4
    assert 0.05 < radial[4] + radial[5] < 0.13


@pytest.mark.slow
@pytest.mark.slow
def test_harmonics_are_moments_of_the_light_on_a_sphere():
    x, weights = np.polynomial.legendre.leggauss(200)
    for r in (2.0, 5.0):
        values = np.asarray(
            jax.vmap(lambda c, r=r: sphere_scattering(SKIN, jnp.arccos(c), 1 / r))(x)
        )
        legendre = np.stack([x, (3 * x * x - 1) / 2])
        # The same moments of max(0, cos θ) are 1/3 and 1/8.
        moments = (legendre * weights) @ values / np.array([[1 / 3], [1 / 8]])
        np.testing.assert_allclose(moments.T, harmonic_factors(SKIN, 1 / r), atol=1e-9)


@pytest.mark.slow
def test_harmonics_have_no_jump_and_the_right_limits():
    for width in (0.5**0.5, 1.4142):
        below, above = (np.asarray(lobe_harmonics(width * f)) for f in (1 - 1e-9, 1 + 1e-9))
        np.testing.assert_allclose(below, above, atol=1e-8)
    np.testing.assert_allclose(lobe_harmonics(30.0), [1 / 2700, 1 / 900**2 / 15], rtol=1e-5)
    np.testing.assert_allclose(harmonic_factors(SKIN, 1e-9), 1.0, atol=1e-12)
    slopes = jax.jacfwd(lambda k: harmonic_factors(SKIN, k))(jnp.array([0.0, 1e-6, 0.3, 50.0])[2])
    assert np.isfinite(slopes).all()


def test_burleys_harmonics_are_those_of_its_gaussians():
    gaussians = burley_as_gaussians(0.7)
    for r in (1.0, 5.0, 30.0):
        found = harmonic_factors(gaussians, 1 / r)[0]
        np.testing.assert_allclose(found, burley_harmonics(0.7, 1 / r), atol=1e-9)
