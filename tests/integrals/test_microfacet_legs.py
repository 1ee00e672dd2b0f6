"""E by independent methods, anisotropic albedos, limits, and averages of Fresnel reflectances."""

import functools

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from integrals.microfacet import (
    ANISOTROPIC_ALBEDO,
    anisotropic_albedo,
    average_albedo,
    conductor_average,
    dielectric_average,
    dielectric_average_by_quadrature,
    directional_albedo,
    directional_albedo_by_ellipse,
    directional_albedo_by_sampling,
    fully_rough_albedo,
    fully_rough_uncorrelated_albedo,
    normal_albedo,
    schlick_average,
    smooth_limit,
)
from integrals.microfacet.random_walk import schlick, walk
from shading import direction
from shading.microfacet import conductor, uncorrelated_visibility
from tests.batches import batched
from tests.integrals.differences import difference

EPS = np.finfo(float).eps
# αx, αy, θ and φ in degrees, E: computed apart from this package, to 1e-12.
ANISOTROPIC = np.array(
    [
        (0.2, 0.8, 60, 40, 0.663833520550),
        (0.05, 0.5, 85, 70, 0.919551381264),
        (0.3, 0.6, 20, 10, 0.711515576482),
    ]
)
# α, μ: grazing and normal views, and views in the dip near μ = α.
POINTS = np.array(
    [(0.05, 0.05), (0.05, 1.0), (0.07, 1e-4), (0.1, 0.12), (0.3, 0.9), (0.7, 0.3), (1.0, 0.2)]
).T


@functools.cache
def one_dimensional():
    return batched(directional_albedo, 8)


@functools.cache
def ellipse():
    return batched(ANISOTROPIC_ALBEDO.quadrature, 4)


@functools.cache
def limit():
    return batched(smooth_limit, 8)


def view(mu) -> np.ndarray:
    return np.array([np.sqrt((1 - mu) * (1 + mu)), 0.0, mu])


@pytest.mark.slow
def test_ellipse_agrees_with_the_integral_over_the_cosine():
    alpha, mu = POINTS
    value, error = ellipse()(alpha, alpha, np.arccos(mu), np.linspace(0, 3, len(mu)))
    exact, allowance = one_dimensional()(mu, alpha)
    assert np.all(abs(value - exact) <= error + allowance)
    np.testing.assert_allclose(value, exact, rtol=0, atol=1e-12)
    assert np.all(error < 1e-8)


def test_anisotropic_albedo_has_known_values():
    alpha_x, alpha_y, theta, phi, exact = ANISOTROPIC.T
    value, error = ellipse()(alpha_x, alpha_y, np.radians(theta), np.radians(phi))
    np.testing.assert_allclose(value, exact, rtol=0, atol=5e-11)
    assert np.all(abs(value - exact) <= error + 1e-12)
    assert np.all(error < 1e-8)
    # Exchanged axes.
    value, _ = ellipse()(alpha_y, alpha_x, np.radians(theta), np.radians(90 - phi))
    np.testing.assert_allclose(value, exact, rtol=0, atol=5e-11)


@pytest.mark.slow
def test_anisotropic_albedo_is_exact_to_1e_10_up_to_a_ratio_of_ten():
    rng = np.random.default_rng(0)
    narrow, ratio = np.exp(rng.uniform(np.log(0.05), np.log(0.5), 32)), rng.uniform(1, 10, 32)
    wide = np.minimum(narrow * ratio, 1.0)
    theta, phi = np.arccos(rng.random(32) ** 2), rng.uniform(0, np.pi / 2, 32)
    value, error = ellipse()(narrow, wide, theta, phi)

    def fine(alpha_x, alpha_y, theta, phi):
        widths = jnp.stack([alpha_x, alpha_y])
        return anisotropic_albedo(direction(theta, phi), widths, nodes=128, azimuths=3072)

    truth, allowance = batched(fine, 1)(narrow, wide, theta, phi)
    assert np.all(abs(value - truth) <= error + allowance)
    np.testing.assert_allclose(value, truth, rtol=0, atol=1e-10)


@pytest.mark.slow
def test_ellipse_has_any_fresnel_reflectance():
    """Schlick's reflectance for F0 = 0 gives B of the Fresnel split."""
    mu, alpha = 0.3, 0.25
    found = anisotropic_albedo(view(mu), alpha, fresnel=lambda x: (1 - x) ** 5, azimuths=128)
    # The value that `fresnel_split` is tested with.
    assert abs(found.value - 0.0653702498986) < 1e-12


@pytest.mark.slow
def test_ellipse_is_exact_for_small_alpha():
    alpha, mu = np.array([(0.01, 0.01), (0.01, 1.0), (0.02, 1e-4), (0.03, 0.5)]).T
    value, error = batched(directional_albedo_by_ellipse, 4)(mu, alpha)
    exact, allowance = one_dimensional()(mu, alpha)
    assert np.all(abs(value - exact) <= error + allowance)
    np.testing.assert_allclose(value, exact, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_derivatives_of_the_ellipse_are_those_of_the_integral_over_the_cosine():
    mu, alpha = np.array([1e-9, 0.05, 0.4, 1.0]), np.array([0.3, 0.1, 1.0, 0.3])

    def by_ellipse(mu, alpha):
        return directional_albedo_by_ellipse(mu, alpha, nodes=48, azimuths=128).value

    found = batched(jax.grad(by_ellipse, (0, 1)), 4)(mu, alpha)
    exact = batched(jax.grad(lambda m, a: directional_albedo(m, a).value, (0, 1)), 4)(mu, alpha)
    assert np.isfinite(found).all()
    # Below μ = 1e-9 the slope grows without bound, and the rules no longer resolve it.
    np.testing.assert_allclose(np.array(found)[:, 1:], np.array(exact)[:, 1:], rtol=0, atol=2e-6)


@pytest.mark.parametrize("sequence", ["random", pytest.param("sobol", marks=pytest.mark.slow)])
def test_monte_carlo_is_within_five_standard_errors(sequence):
    alpha, mu = POINTS
    one = functools.partial(directional_albedo_by_sampling, samples=1 << 14, sequence=sequence)
    value, error = batched(one, 8)(mu, alpha)
    exact = one_dimensional()(mu, alpha).value
    assert np.all(abs(value - exact) <= 5 * error)
    assert np.all(error < 1e-2)


def test_legs_of_the_anisotropic_albedo_agree():
    alpha_x, alpha_y, theta, phi, exact = ANISOTROPIC.T
    one = functools.partial(ANISOTROPIC_ALBEDO.monte_carlo, samples=1 << 14)
    value, error = batched(one, 4)(alpha_x, alpha_y, np.radians(theta), np.radians(phi))
    assert np.all(abs(value - exact) <= 5 * error)
    assert ANISOTROPIC_ALBEDO.best_leg == "quadrature"


def test_walk_leaves_after_one_reflection_as_often_as_the_albedo_says():
    for alpha, mu in ((0.6, 0.5), (0.1, 0.12), (1.0, 1.0)):
        first, _, total = walk(view(mu), alpha, paths=1 << 14)
        exact = one_dimensional()(np.array([mu]), np.array([alpha])).value[0]
        assert abs(float(first.value[0]) - exact) <= 5 * float(first.error[0])
        # With F = 1 everything leaves, but for paths that were dropped.
        assert 1 - 1e-4 < float(total.value[0]) <= 1


@pytest.mark.slow
def test_walk_of_an_anisotropic_surface_with_fresnel_reflectance():
    at = np.asarray(direction(1.0, 0.7))
    widths = np.array([0.2, 0.8])
    found = walk(at, widths, reflectance=schlick(0.0, 0.3), paths=400_000).first
    for index, f0 in enumerate((0.0, 0.3)):
        exact = anisotropic_albedo(at, widths, fresnel=lambda x, f=f0: f + (1 - f) * (1 - x) ** 5)
        assert abs(float(found.value[index]) - exact.value) <= 5 * float(found.error[index])


def test_walk_refuses_bad_input():
    with pytest.raises(ValueError, match="z must be positive"):
        walk(np.array([1.0, 0, 0]), 0.5)
    with pytest.raises(ValueError, match="alpha = 0"):
        walk(np.array([0.0, 0, 1]), 0.0)
    with pytest.raises(ValueError, match="paths = 1"):
        walk(np.array([0.0, 0, 1]), 0.5, paths=1)


@pytest.mark.slow
def test_limit_of_smooth_surfaces():
    x = np.array([0.0, 1e-3, 0.2, 1.1, 4.0, 50.0])
    value, error = limit()(x)

    def integrand(y, x):
        across = x * np.sqrt(1 + y * y) + y * np.sqrt(1 + x * x)
        return 2 * y * (x + y) / (across * ((y - x) ** 2 + 4) ** 1.5)

    for ratio, found, stated in zip(x[2:5], value[2:5], error[2:5], strict=True):
        expected, allowance = quad(integrand, 0, np.inf, args=(ratio,), epsabs=1e-12, limit=200)
        assert abs(found - expected) <= stated + allowance
    assert np.all(error < 1e-12)
    # e is 1 − 0.21106 x near zero, where the number is ½E(m = −3) − 1 with a complete elliptic
    # integral, and 1 − 1/(2x²) for large x.
    slope = float(mp.ellipe(-3) / 2 - 1)
    assert abs(value[0] - 1) < 1e-11
    np.testing.assert_allclose((1 - value[1]) / x[1], slope, rtol=1e-2)
    steep = batched(jax.grad(lambda x: smooth_limit(x).value), 2)(np.array([0.0, 1e-9]))
    np.testing.assert_allclose(steep, -slope, rtol=1e-5)
    np.testing.assert_allclose((1 - value[5]) * 2 * x[5] ** 2, 1, rtol=4e-2)


def test_a_ninth_of_the_energy_is_missing_however_smooth_the_surface_is():
    lowest = minimize_scalar(
        lambda x: limit()(np.array([x])).value[0], bounds=(0.5, 2), options={"xatol": 1e-7}
    )
    assert abs(lowest.fun - 0.8914527) < 1e-7
    assert abs(lowest.x - 1.1062) < 1e-4
    # E(αx, α) tends to e(x) quadratically in α.
    alpha = np.array([0.02, 0.01])
    gap = one_dimensional()(lowest.x * alpha, alpha).value - lowest.fun
    np.testing.assert_allclose(gap[0] / gap[1], 4, rtol=0.02)


def test_expansions_of_the_directional_albedo():
    """1 − E is α²(1 + 1/μ²)/2 for α ≪ μ, α² + (4/3)α³ at μ = 1, and αμ(ln(1/μ) + c₁/α) near 0."""
    missing = 1 - one_dimensional()(np.array([0.5, 1.0]), np.array([0.01, 0.01])).value
    np.testing.assert_allclose(missing[0], 1e-4 * (1 + 4) / 2, rtol=0.04)
    np.testing.assert_allclose(missing[1], 1e-4 * (1 + 4 / 3 * 0.01), rtol=2e-3)
    # Measured constants c₁(α).
    alpha, constant = np.array([1, 0.5, 0.3, 0.1]), [0, 0.2586692, 0.5273197, 1.967887]
    mu = np.full(4, 1e-6)
    missing = (1 - one_dimensional()(mu, alpha).value) / mu
    np.testing.assert_allclose(missing - alpha * np.log(1 / mu), constant, rtol=0, atol=2e-4)


@pytest.mark.slow
def test_expansion_of_the_average_albedo():
    alpha = 0.01
    leading = np.log(1 / alpha) + 3 / 5 + 19 / 15 * np.log(2) - 9 / 10 * np.log(3)
    next_order = alpha**2 * (np.log(1 / alpha) / 2 - 0.9406)
    missing = (1 - average_albedo(alpha).value) / alpha**2
    np.testing.assert_allclose(missing, leading + next_order, rtol=0, atol=2e-6)


@pytest.mark.slow
def test_edges_have_closed_forms():
    mu, alpha = np.array([0.01, 0.4, 1.0]), np.array([0.1, 0.5, 0.95])
    np.testing.assert_allclose(
        one_dimensional()(mu, np.ones(3)).value,
        jax.vmap(fully_rough_albedo)(mu),
        rtol=0,
        atol=1e-14,
    )
    one = functools.partial(directional_albedo, visibility=uncorrelated_visibility)
    value = batched(one, 8)(np.append(mu, 1.0), np.array([1, 1, 1, 0.5])).value
    np.testing.assert_allclose(
        value[:3], jax.vmap(fully_rough_uncorrelated_albedo)(mu), rtol=0, atol=1e-14
    )
    # At normal incidence Λ(o) = 0, and both kinds of masking are the same.
    assert abs(value[3] - one_dimensional()(np.ones(1), np.array([0.5])).value[0]) < 1e-14
    np.testing.assert_allclose(
        one_dimensional()(np.ones(3), alpha).value,
        jax.vmap(normal_albedo)(alpha),
        rtol=0,
        atol=1e-11,
    )


def test_average_of_a_dielectric_has_a_closed_form():
    index = np.array([0.3, 0.7, 1 - 1e-6, 1.0, 1 + 1e-9, 1.01, 1.33, 1.5, 2.0, 2.01, 4.0, 10.0])
    value, error = batched(dielectric_average, 12)(index)
    other, allowance = batched(dielectric_average_by_quadrature, 12)(index)
    assert np.all(abs(value - other) <= error + allowance)
    np.testing.assert_allclose(value, other, rtol=0, atol=1e-14)


@pytest.mark.slow
def test_slope_of_the_average_of_a_dielectric():
    index = np.array([0.3, 0.7, 1 - 1e-6, 1.0, 1 + 1e-9, 1.01, 1.33, 1.5, 2.0, 2.01, 4.0, 10.0])
    slopes = batched(jax.grad(lambda n: dielectric_average(n).value), 12)(index)
    assert np.isfinite(slopes).all()
    np.testing.assert_allclose(slopes[3:5], 1 / 3, rtol=1e-6)
    np.testing.assert_allclose(slopes[2], -7 / 3, rtol=1e-4)
    away = index[abs(index - 1) > 0.1]
    expected = difference(
        lambda x: np.asarray(jax.vmap(dielectric_average)(x[0]).value), away[None], 0, 1e-3, 0, 99
    )
    np.testing.assert_allclose(slopes[abs(index - 1) > 0.1], expected, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_average_of_schlick_and_of_conductors():
    def average(function):
        return quad(lambda x: 2 * x * float(function(x)), 0, 1, epsabs=1e-13, limit=200)[0]

    np.testing.assert_allclose(
        schlick_average(0.3), average(lambda x: 0.3 + 0.7 * (1 - x) ** 5), rtol=0, atol=1e-14
    )
    # Silver, gold and tungsten in red light, and a dielectric.
    for eta, k in ((0.16, 3.9), (0.18, 3.07), (3.64, 2.8), (1.5, 0.0)):
        value, error = conductor_average(eta, k)
        expected = average(jax.jit(lambda x, n=eta, k=k: conductor(x, n, k)))
        assert abs(value - expected) <= error + 1e-12
        assert error < 1e-12
    np.testing.assert_allclose(
        conductor_average(1.5, 0.0).value, dielectric_average(1.5).value, rtol=0, atol=1e-14
    )
    slopes = jax.grad(lambda n, k: conductor_average(n, k).value, (0, 1))(1.5, 0.0)
    assert np.isfinite(slopes).all()
