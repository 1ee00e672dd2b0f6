"""Fits of the ambient models, their errors, and where their radiance can be negative."""

import functools

import jax
import numpy as np
import pytest

from integrals.fuzz.radiance import layer_response
from quantities.fuzz.ambient_fit import (
    LOBES,
    Samples,
    fit_lit_fraction,
    fit_model,
    fitting_lights,
    model_weights,
    radiance_errors,
    samples,
    samples_at,
)
from quantities.fuzz.ambient_range import least_variances, moments_of_weights
from shading import AMBIENT_MODELS, LayerView, harmonics
from shading.fuzz.ambient import LIT_FRACTION_CONSTANTS


@functools.cache
def some():
    """Return exact values at points that no fit uses."""
    return samples(6, 7)


many_harmonics = jax.vmap(harmonics)


def light_of_square(line, level):
    """Return the harmonics (9,) of (u·line − level)² by a rule that is exact for order 4."""
    z, w = np.polynomial.legendre.leggauss(4)
    phi = np.arange(8) * np.pi / 4
    sine = np.sqrt(1 - z**2)
    u = np.stack(
        [np.outer(sine, np.cos(phi)), np.outer(sine, np.sin(phi)), np.outer(z, np.ones(8))], axis=-1
    ).reshape(-1, 3)
    weights = np.repeat(w, 8) * np.pi / 4
    return (weights * (u @ line - level) ** 2) @ np.asarray(many_harmonics(u))


def weights_of_directions():
    """Return the weights (6, 9) of positive measures of twenty directions each, and the latter."""
    random = np.random.default_rng(4)
    u = random.normal(size=(6, 20, 3)) + np.array([0.5, 0.2, 1.5])
    u /= np.linalg.norm(u, axis=2)[:, :, None]
    mass = random.random((6, 20)) / 20
    values = np.asarray(many_harmonics(u.reshape(-1, 3))).reshape(6, 20, 9)
    return np.einsum("ij,ijk->ik", mass, values), u, mass


def test_lights_are_lobes():
    lights = fitting_lights()
    assert lights.shape == (9, 1 + len(LOBES))
    u = np.array([0.36, 0.48, 0.8])
    axes = np.array(LOBES) / np.linalg.norm(LOBES, axis=1)[:, None]
    expected = [1.0, *((1 + axes @ u) / 2) ** 2]
    np.testing.assert_allclose(np.asarray(harmonics(u)) @ lights, expected, rtol=0, atol=1e-14)


def test_moments_are_those_of_the_directions():
    weights, u, mass = weights_of_directions()
    total, mean, square = moments_of_weights(weights)
    np.testing.assert_allclose(total, mass.sum(axis=1), rtol=1e-14)
    share = mass / mass.sum(axis=1)[:, None]
    np.testing.assert_allclose(mean, np.einsum("ij,ijk->ik", share, u), rtol=0, atol=1e-14)
    second = np.einsum("ij,ijk,ijl->ikl", share, u, u)
    np.testing.assert_allclose(square, second, rtol=0, atol=1e-14)
    assert least_variances(weights).min() > 0


def test_negative_variance_is_a_negative_radiance():
    """A light (u·e − R·e)² sends M0 times the variance along e, and other lights no less."""
    weights, _, _ = weights_of_directions()
    weights[:, 4:] *= 1.6
    variances = np.asarray(least_variances(weights))
    assert variances.min() < 0
    total, mean, square = map(np.asarray, moments_of_weights(weights))
    for index, variance in enumerate(variances):
        spread = square[index] - np.outer(mean[index], mean[index])
        line = np.linalg.eigh(spread)[1][:, 0]
        light = light_of_square(line, mean[index] @ line)
        assert abs(weights[index] @ light - total[index] * variance) < 1e-13
        other = weights[index] @ light_of_square(line, 0.3)
        assert other >= total[index] * variance - 1e-13


# The rms errors at 64 points that no fit uses, in % of the mean, in uniform light and in the worst
# of the eleven lobes, by model. They are about a fifth above what was measured.
ALLOWED = {
    "talk": (30, 120),
    "cheap": (8, 120),
    "cheap-directed": (8, 40),
    "mean-cosine": (4.5, 120),
    "mean-direction": (4.5, 20),
    "recommended": (4.5, 13),
    "best": (3.5, 9),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", list(AMBIENT_MODELS))
def test_errors_elsewhere(name):
    found = 100 * radiance_errors(AMBIENT_MODELS[name], some(), fitting_lights())
    uniform, lobes = ALLOWED[name]
    assert found[0] < uniform
    assert found[1:].max() < lobes


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name, each in AMBIENT_MODELS.items() if each.constants])
def test_constants_are_those_of_the_fit(name):
    """The constants are rounded to four decimals."""
    model = AMBIENT_MODELS[name]
    fitted = fit_model(model, fitting_samples())
    assert fitted.converged
    np.testing.assert_allclose(fitted.constants, model.constants, rtol=0, atol=1.5e-4)


def test_the_constants_of_lit_fraction_are_those_of_the_fit():
    """They are rounded to two and three decimals."""
    fitted = fit_lit_fraction()
    assert fitted.converged
    off = np.abs(fitted.z - LIT_FRACTION_CONSTANTS)
    assert off[0] < 5e-3
    assert off[1] < 5e-4


@functools.cache
def fitting_samples():
    return samples()


@pytest.mark.slow
def test_exact_values_do_not_depend_on_the_rule():
    """At α = 0.05, where directions change most quickly."""
    points = np.array([(0.05, 1.2, 0.1, 1.4, 0.3), (0.05, 0.4, 0.05, 1.5, 2.5)])
    for point, weights in zip(points, samples_at(points).weights, strict=True):
        fine = layer_response(*point, step=1 / 20, azimuths=600)
        np.testing.assert_allclose(weights, fine, rtol=0, atol=2e-4 * weights[0])


@pytest.mark.slow
def test_exact_moments_have_a_variance():
    assert least_variances(some().weights).min() > 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mean-direction", "recommended", "best"])
def test_negative_variances_are_rare_and_small(name):
    """Nothing is proven for these models. docs/ambient-light.md has a search of more points."""
    random = np.random.default_rng(12)
    count = 20_000
    alpha, density = random.uniform(0.15, 1, count), 10 ** random.uniform(-3, 0.5, count)
    theta_f, phi = np.arccos(random.random(count)), random.uniform(0, np.pi, count)
    cosine = random.uniform(1e-3, 1, count)
    sine = np.sqrt(1 - cosine**2)
    v = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1)
    t = np.stack([np.sin(theta_f), 0 * theta_f, np.cos(theta_f)], axis=1)
    ones = np.full(count, 0.5)
    view = LayerView(cosine, np.sum(v * t, axis=1), t[:, 2], alpha, density, ones, ones)
    variances = least_variances(
        model_weights(AMBIENT_MODELS[name], Samples(view, v, t, np.zeros((count, 9))))
    )
    assert variances.min() > -0.05
    assert np.mean(variances < 0) < 1e-3
