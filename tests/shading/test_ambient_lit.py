"""The corrected ambient layer: its errors in uniform light, limits, range, and its constants."""

import functools

import jax
import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.stats import qmc

from integrals import PS, G
from integrals.fuzz.lit import E_LIT
from integrals.fuzz.radiance import layer_moments
from shading import ambient_layer, ambient_layer_lit, lit_fraction
from shading.fuzz import ambient
from tests.batches import batched

# The radiance of the layer over points with all axes even, and the density even in its logarithm.
LEAST_ALPHA, LEAST_COSINE, DENSITIES = 0.15, 0.05, (0.01, 0.5)


def materials(seed, exponent) -> np.ndarray:
    """Return 2^`exponent` Sobol' points (α, θf, d, θv, φ), shape (5, count)."""
    u = qmc.Sobol(5, rng=np.random.default_rng(seed)).random_base2(exponent).T
    low, high = DENSITIES
    return np.stack(
        [
            LEAST_ALPHA + (1 - LEAST_ALPHA) * u[0],
            u[1] * np.pi / 2,
            low * (high / low) ** u[4],
            np.arccos(LEAST_COSINE + (1 - LEAST_COSINE) * u[2]),
            u[3] * np.pi,
        ]
    )


def exact_lit(points):
    return batched(functools.partial(E_LIT.quadrature, nodes=96), 64)(*points[[0, 1, 3, 4]]).value


def exact_layer(points):
    rule = functools.partial(layer_moments, azimuths=96)
    return batched(rule, 8)(*points).total


def arguments(points):
    """Return G, P_s, v·t, n·t and α."""
    alpha, theta_f, density, theta_v, phi = points
    cos_vt = np.sin(theta_v) * np.cos(phi) * np.sin(theta_f) + np.cos(theta_v) * np.cos(theta_f)
    scattered = batched(PS.value, 64)(alpha, theta_f, theta_v, phi)
    scattering = batched(G.value, 64)(density, np.cos(theta_v))
    return scattering, scattered, cos_vt, np.cos(theta_f), alpha


def on_points(function):
    """Return `function` of scalars as one of arrays (count,)."""
    compiled = jax.jit(jax.vmap(function))
    return lambda *columns: np.asarray(compiled(*columns))


lits = on_points(lit_fraction)
corrected = on_points(functools.partial(ambient_layer_lit, 1.0, 1.0))


def relative(value, exact) -> tuple[float, float]:
    """Return the rms and the largest error, both relative to the mean of the exact values."""
    error = np.abs(value - exact) / exact.mean()
    return np.sqrt(np.mean(error**2)), error.max()


def test_lit_fraction_is_near_e_lit():
    points = materials(11, 8)
    _, scattered, cos_vt, _, alpha = arguments(points)
    exact = exact_lit(points)
    rms, largest = relative(lits(scattered, cos_vt, alpha), exact)
    assert rms < 0.02
    assert largest < 0.2
    # 1 − P_s in its place has five times the error.
    assert relative(1 - scattered, exact)[0] > 0.08


def test_layer_in_uniform_light():
    points = materials(12, 8)
    scattering, scattered, *rest = arguments(points)
    exact = exact_layer(points)
    rms, largest = relative(corrected(scattering, scattered, *rest), exact)
    assert rms < 0.05
    assert largest < 0.5
    # The model of the talk has three times the error.
    assert relative(scattering * (1 - scattered), exact)[0] > 0.12
    layer = ambient_layer(1.0, 1.0, scattering[0], scattered[0])
    assert abs(layer - scattering[0] * (1 - scattered[0])) < 1e-15


def test_limits():
    """E_lit is 1 − P_s for isotropic and for infinitely thin fibres."""
    for alpha in (1.0, 1e-9):
        np.testing.assert_allclose(lit_fraction(0.3, 0.6, alpha), 0.7, rtol=1e-8)


def test_even_in_the_fibre_and_linear_in_the_light():
    mean, albedo = np.array([0.5, 1.0, 2.0]), np.array([0.9, 0.2, 0.4])
    one = ambient_layer_lit(mean, albedo, 0.3, 0.6, 0.5, -0.2, 0.4)
    other = ambient_layer_lit(1.0, 1.0, 0.3, 0.6, -0.5, 0.2, 0.4)
    np.testing.assert_allclose(one, mean * albedo * other, rtol=1e-14)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_finite_and_never_negative(dtype):
    """For any values of the arguments in their ranges, as fits of P_s and of G may give them."""
    ends = np.meshgrid([0, 0.4, 1], [0, 0.5, 1], [-1, 0.3, 1], [0, 0.7, 1], [1e-6, 0.05, 0.5, 1])
    columns = [each.ravel().astype(dtype) for each in ends]
    value = corrected(*columns)
    assert value.dtype == dtype
    assert np.all(np.isfinite(value))
    assert np.all(value >= 0)


@pytest.mark.slow
def test_constants_are_those_of_a_least_squares_fit():
    points = materials(1, 13)
    scattering, scattered, cos_vt, cos_nt, alpha = arguments(points)
    kappa, up = 1 - alpha**2, 1 - scattered
    view2, normal2 = 1 - kappa * cos_vt**2, 1 - kappa * cos_nt**2

    def lit(k):
        square = cos_vt**2 * (1 - k[0] * alpha) + k[1] * alpha * up
        return up * np.sqrt(view2 / (1 - kappa * square))

    def layer(k):
        return lit(k) * scattering * (k[2] + k[3] * up * np.sqrt(view2 * normal2))

    exact = exact_lit(points)
    fitted = least_squares(lambda k: lit(k) - exact, [1.0, 1.0]).x
    np.testing.assert_allclose(fitted, ambient.LIT_FRACTION_CONSTANTS, rtol=0, atol=5e-3)
    total = exact_layer(points)
    fitted = least_squares(lambda k: layer(k) - total, [1.0, 1.0, 1.0, 0.0]).x
    np.testing.assert_allclose(fitted, ambient.LIT_LAYER_CONSTANTS, rtol=0, atol=5e-4)
