"""Integrals of the whole fuzz BRDF over the hemisphere: limits, energy, the ambient model."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals import PS, G, Q
from integrals.fuzz.radiance import base_response, layer_albedo, layer_moments, layer_response
from shading import (
    ambient_attenuation,
    ambient_layer,
    ambient_radiance,
    direction,
    escape,
    fiber_direction,
    fiber_root,
    irradiance,
    layer_brdf,
    mean_radiance,
    penetration,
    sample_phase_function,
)
from tests.batches import batched
from tests.integrals.problems import exact_g, exact_q

# The error of the default rule for α ≥ 0.15, d ≥ 0.01 and cosines ≥ 0.1.
RULE = 1e-5

# Light of radiance one from all directions.
UNIFORM = np.zeros(9)
UNIFORM[0] = np.sqrt(4 * np.pi)


def materials(seed, count) -> np.ndarray:
    """Return random (α, θf, d, θ, φ), shape (5, count), in the domain of the default rule."""
    rng = np.random.default_rng(seed)
    return np.stack(
        [
            np.exp(rng.uniform(np.log(0.15), 0, count)),
            rng.uniform(0, np.pi / 2, count),
            np.exp(rng.uniform(np.log(0.01), 0, count)),
            np.arccos(rng.uniform(0.1, 1, count)),
            rng.uniform(0, np.pi, count),
        ]
    )


layers = batched(layer_response, 8)
bases = batched(base_response, 8)
albedos = batched(layer_albedo, 8)
fractions = batched(PS.value, 8)


@pytest.mark.slow
def test_default_rule_is_as_precise_as_stated():
    points = materials(0, 64)
    fine = functools.partial(layer_response, step=1 / 20, azimuths=320)
    assert np.abs(layers(*points) - batched(fine, 8)(*points)).max() < RULE


def test_isotropic_fibres_reflect_half_of_g():
    """With p = 1/4π the radiance of the layer in uniform light is G/2."""
    points = materials(1, 8)
    points[0] = 1.0
    values = layers(*points) @ UNIFORM
    exact = [float(exact_g(d, np.cos(theta))) / 2 for d, theta in points[2:4].T]
    np.testing.assert_allclose(values, exact, atol=RULE)


def test_unscattered_light_on_the_base_is_q():
    points = materials(2, 8)
    unscattered, scattered = (part @ UNIFORM / np.pi for part in bases(*points[:3]))
    q = np.array([float(exact_q(d)) for d in points[2]])
    np.testing.assert_allclose(unscattered, q, atol=RULE)
    assert np.all(scattered > 0)
    assert np.all(scattered < 1 - q)


def test_layer_albedo_agrees_with_sampled_reflections():
    """Compare the rule with Monte Carlo, within five standard errors."""

    def sampled(alpha, theta_f, density, theta_u, phi_u):
        root, light = fiber_root(fiber_direction(theta_f), alpha), direction(theta_u, phi_u)

        def escaping(point):
            view = sample_phase_function(root, light, point)
            up = jnp.maximum(view[2], 1e-9)
            value = layer_brdf(1.0, light[2], up, density, 1.0) * up
            return jnp.where(view[2] > 0, value, 0.0)

        values = jax.vmap(escaping)(np.random.default_rng(3).random((40_000, 2)))
        return values.mean(), jnp.std(values) / 200

    points = materials(3, 8)
    mean, error = batched(sampled, 8)(*points)
    assert np.all(abs(mean - albedos(*points)) < 5 * error + RULE)


def test_layer_and_base_create_no_energy():
    """White fibres over a white base never reflect more than arrives, for any light."""
    points = materials(4, 32)
    alpha, theta_f, density, theta_u, phi = points
    passing = np.asarray(penetration_of(np.cos(theta_u), density))
    down = fractions(alpha, theta_f, theta_u, phi)
    layer = albedos(*points)
    assert np.all(layer <= (1 - passing) * (1 - down) + RULE)
    through = (passing + (1 - passing) * down) * [float(exact_q(d)) for d in density]
    assert np.all(layer + through <= 1 + RULE)


penetration_of = jax.vmap(penetration)


@pytest.mark.slow
def test_ambient_model_is_exact_for_isotropic_fibres_in_uniform_light():
    density, theta_v = 0.3, 0.9
    albedo, base = np.array([0.9, 0.5, 0.1]), np.array([0.2, 0.4, 0.6])
    normal = np.array([0.0, 0.0, 1.0])
    layer = ambient_layer(
        mean_radiance(UNIFORM, normal), albedo, G.value(density, np.cos(theta_v)), 0.5
    )
    attenuation = ambient_attenuation(np.cos(theta_v), density, albedo, Q.value(density), 0.5)
    model = ambient_radiance(layer, attenuation, base, irradiance(UNIFORM, normal))
    (response,) = layers([1.0], [0.4], [density], [theta_v], [0.0])
    unscattered, scattered = (part[0] @ UNIFORM for part in bases([1.0], [0.4], [density]))
    below = base / np.pi * escape(np.cos(theta_v), density) * (unscattered + albedo * scattered)
    np.testing.assert_allclose(model, albedo * (response @ UNIFORM) + below, atol=RULE)


# The moments of the layer

# (α, θf, d, θv, φ), M0 and M1/M0, from a rule of which two step sizes agree.
PLACES = np.array(
    [
        (0.5, np.pi / 4, 0.2, np.pi / 3, np.pi / 3),
        (np.sqrt(0.05), np.pi / 4, 0.2, np.arccos(0.35), np.pi / 4),
        (np.sqrt(0.05), np.pi / 2, 0.5, np.arccos(0.1), np.pi),
        (np.sqrt(0.5), np.radians(23), 0.1, np.arccos(0.7), np.radians(135)),
        (1.0, 0.0, 0.2, np.pi / 3, 0.0),
    ]
).T
TOTALS = (0.0694883, 0.0267475, 0.1968331, 0.0477658, 0.1241947)
MEANS = (
    (-0.31815, 0.17400, 0.47472),
    (-0.63161, 0.25076, 0.29492),
    (0.83339, 0.0, 0.30350),
    (-0.15606, 0.05888, 0.52143),
    (0.0, 0.0, 0.56319),
)
moments = batched(layer_moments, 8)


def test_moments_of_the_layer():
    value = moments(*PLACES)
    np.testing.assert_allclose(value.total, TOTALS, rtol=0, atol=1e-7)
    np.testing.assert_allclose(value.first / value.total[:, None], MEANS, rtol=0, atol=1e-5)
    np.testing.assert_allclose(np.trace(value.second, axis1=1, axis2=2), value.total, rtol=1e-12)


def test_moments_give_the_radiance_in_light_of_nine_harmonics():
    points = materials(11, 8)
    value, response = moments(*points), layers(*points)
    np.testing.assert_allclose(response[:, 0], value.total * np.sqrt(1 / (4 * np.pi)), rtol=1e-12)
    linear = value.first[:, [1, 2, 0]] * np.sqrt(3 / (4 * np.pi))
    np.testing.assert_allclose(response[:, 1:4], linear, rtol=0, atol=1e-13)
    xx, yy, zz = (value.second[:, i, i] for i in range(3))
    xy, yz, xz = (value.second[:, i, j] for i, j in ((0, 1), (1, 2), (0, 2)))
    scale = np.sqrt(15 / (4 * np.pi))
    quadratic = [xy, yz, (2 * zz - xx - yy) / np.sqrt(12), xz, (xx - yy) / 2]
    np.testing.assert_allclose(response[:, 4:].T, scale * np.stack(quadratic), rtol=0, atol=1e-13)
