"""What Kulla and Conty return, Hill's colour, Turquin's factor: furnace, reciprocity, the walk."""

import functools

import jax
import numpy as np
import pytest
from scipy.optimize import least_squares

from integrals.microfacet import average_albedo, directional_albedo, fresnel_split, schlick_average
from integrals.microfacet.random_walk import schlick, walk
from shading.microfacet import (
    color_by_hill,
    color_by_kulla_conty,
    color_of_walk,
    multiple_scattering,
    turquin_scale,
)
from tests.batches import batched


@functools.cache
def albedo():
    return batched(lambda mu, alpha: directional_albedo(mu, alpha).value, 64)


def returned(albedo_view, average, alpha, nodes=64):
    """Return ∫ f_ms ν dω for F = 1, with E of `albedo`, by a rule in which E is smooth."""
    x, weights = np.polynomial.legendre.leggauss(nodes)
    top = np.sqrt(np.arcsinh(1 / alpha))
    t = top * (x + 1) / 2
    nu, slope = alpha * np.sinh(t * t), alpha * np.cosh(t * t) * 2 * t * top / 2
    light = albedo()(nu, np.full(nodes, alpha))
    values = jax.vmap(multiple_scattering, (None, 0, None))(albedo_view, light, average)
    return 2 * np.pi * np.sum(weights * slope * nu * np.asarray(values))


@pytest.mark.parametrize("alpha", [0.05, 0.3, 1.0])
def test_white_furnace(alpha):
    """With exact E and E_avg, single and multiple scattering return everything."""
    average = float(average_albedo(alpha).value)
    for view in albedo()(np.array([0.02, 0.3, 1.0]), np.full(3, alpha)):
        assert abs(view + returned(view, average, alpha) - 1) < 1e-12


def test_furnace_error_with_a_fitted_albedo_is_the_error_of_the_fit():
    """If E_avg is the average of the fitted E, f_ms returns 1 − E_fit: the error is E − E_fit."""
    alpha = 0.3
    exact, average = albedo()(np.array([0.4]), np.array([alpha]))[0], average_albedo(alpha).value
    # A fit that is too bright by 2 % of what is missing, and its average.
    fitted, its_average = exact + 0.02 * (1 - exact), average + 0.02 * (1 - average)
    missing = returned(fitted, its_average, alpha) * (1 - 0.02)
    assert abs(exact + missing - 1 - (exact - fitted)) < 1e-12


def test_multiple_scattering_is_reciprocal():
    assert multiple_scattering(0.8, 0.6, 0.7, 0.5) == multiple_scattering(0.6, 0.8, 0.7, 0.5)


def test_colors_are_series_of_reflections():
    f, e = 0.7, 0.6
    series = sum(f * e * (f * (1 - e)) ** k for k in range(1, 200)) / (1 - e)
    np.testing.assert_allclose(color_by_hill(f, e), series, rtol=1e-14)
    np.testing.assert_allclose(color_by_kulla_conty(f, e), series / f, rtol=1e-14)
    for color in (color_by_hill, color_by_kulla_conty, color_of_walk):
        assert float(color(1.0, e)) == pytest.approx(1, abs=1e-15)
        assert color(0.0, e) == 0


def test_turquin_returns_what_is_missing_of_a_white_metal():
    assert 0.6 * float(turquin_scale(1.0, 0.6)) == pytest.approx(1, abs=1e-15)
    assert turquin_scale(0.0, 0.6) == 1


def total_albedos(alpha, mu, f0):
    """Return the albedo with what Hill, Kulla and Conty, Turquin, and `color_of_walk` return."""
    scale, offset = (each.value for each in fresnel_split(mu, alpha))
    single, whole = f0 * scale + offset, scale + offset
    average, fresnel = average_albedo(alpha).value, schlick_average(f0)
    missing = 1 - whole
    return np.array(
        [
            single + color_by_hill(fresnel, average) * missing,
            single + color_by_kulla_conty(fresnel, average) * missing,
            single * turquin_scale(f0, whole),
            single + color_of_walk(fresnel, average) * missing,
        ]
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("alpha", "mu", "f0", "errors"),
    [
        (0.3, 0.5, 0.5, (-0.009, 0.032, -0.008)),
        (0.6, 0.95, 0.5, (-0.007, 0.073, 0.008)),
        (1.0, 0.5, 0.9, (-0.032, 0.009, 0.018)),
        (1.0, 0.95, 0.5, (-0.017, 0.084, 0.043)),
    ],
)
def test_errors_against_the_walk(alpha, mu, f0, errors):
    view = np.array([np.sqrt(1 - mu * mu), 0, mu])
    truth = walk(view, alpha, reflectance=schlick(f0), paths=400_000).total
    found = total_albedos(alpha, mu, f0)[:3] - float(truth.value[0])
    # The errors are printed to 5e-4, and both walks are uncertain.
    np.testing.assert_allclose(found, errors, atol=1e-3 + 4 * float(truth.error[0]))


@pytest.mark.slow
def test_color_of_walk_is_the_best_of_four():
    """Its rms and largest errors over random surfaces are less than half of the others'."""
    rng = np.random.default_rng(7)
    errors = []
    for seed in range(24):
        alpha, mu, f0 = rng.uniform(0.05, 1), rng.uniform(0.02, 1), rng.uniform(0.02, 1)
        view = np.array([np.sqrt(1 - mu * mu), 0, mu])
        truth = walk(view, alpha, reflectance=schlick(f0), paths=200_000, seed=seed).total
        errors.append(total_albedos(alpha, mu, f0) - float(truth.value[0]))
    rms, largest = np.sqrt(np.mean(np.square(errors), axis=0)), np.max(np.abs(errors), axis=0)
    assert np.all(rms[3] < 0.65 * rms[:3])
    assert np.all(largest[3] < 0.6 * largest[:3])
    assert largest[3] < 0.02


@pytest.mark.slow
def test_two_thirds_is_what_a_fit_to_the_walk_gives():
    """Fit q = c(1 − E_avg) to the light that is scattered more than once: c is near 2/3."""
    f0 = np.array([0.1, 0.4, 0.7, 0.9])
    fresnel = (1 + 20 * f0) / 21
    rows = []
    for alpha in (0.2, 0.5, 0.8, 1.0):
        average = float(average_albedo(alpha).value)
        for mu in (0.1, 0.4, 0.7, 1.0):
            view = np.array([np.sqrt(1 - mu * mu), 0, mu])
            found = walk(view, alpha, reflectance=schlick(*f0), paths=100_000).multiple
            missing = 1 - float(albedo()(np.array([mu]), np.array([alpha]))[0])
            rows += list(zip([average] * 4, fresnel, [missing] * 4, found.value, strict=True))
    average, fresnel, missing, exact = np.array(rows, float).T

    def residual(c):
        q = c[0] * (1 - average)
        return fresnel**2 * (1 - q) / (1 - fresnel * q) * missing - exact

    assert abs(least_squares(residual, [1.0]).x[0] - 2 / 3) < 0.03
