"""The fuzz BRDF: limits, reciprocity, energy, and the ambient model where it is exact."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals import PS, G, Q
from integrals.fuzz.radiance import base_response, hemisphere_rule, layer_albedo, layer_response
from shading import (
    ambient_attenuation,
    ambient_layer,
    ambient_radiance,
    asymmetry_from_spread,
    base_attenuation,
    deferred_radiance,
    direction,
    escape,
    fiber_direction,
    fiber_phase_function,
    fiber_projected_area,
    fiber_root,
    harmonics,
    irradiance,
    layer_brdf,
    mean_radiance,
    penetration,
    radiance,
    roughness_from_spread,
    sample_phase_function,
    scattering_kernel,
    wrapped_cosine,
)
from tests.batches import batched
from tests.integrals.problems import exact_g, exact_q

# What the default rule of the hemisphere promises for α ≥ 0.15, d ≥ 0.01, cosines ≥ 0.1.
RULE = 1e-5
UNIFORM = np.zeros(9)
UNIFORM[0] = np.sqrt(4 * np.pi)


def materials(seed, count) -> np.ndarray:
    """Give (α, θf, d, θ, φ) over the domain that the rule is good for."""
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


def test_the_layer_is_the_kernel_times_phase_and_albedo():
    colour = np.array([0.2, 0.5, 0.9])
    brdf = layer_brdf(0.3, 0.4, 0.8, 0.2, colour)
    np.testing.assert_allclose(brdf, colour * 0.3 * scattering_kernel(0.4, 0.8, 0.2) / 0.4)


def test_a_thin_layer_is_linear_in_its_density():
    np.testing.assert_allclose(layer_brdf(0.3, 0.4, 0.8, 1e-12, 1.0), 0.3e-12 / 0.32, rtol=1e-11)


def test_the_layer_is_reciprocal_but_for_the_projected_area():
    fiber, u, v = fiber_direction(0.7), direction(0.4, 1.0), direction(1.2, -2.0)

    def f(u, v, alpha):
        return layer_brdf(fiber_phase_function(u, v, fiber, alpha), u[2], v[2], 0.3, 1.0)

    there, back = f(u, v, 0.3), f(v, u, 0.3)
    assert abs(there / back - 1) > 0.1
    areas = [fiber_projected_area(w @ fiber, 0.3) for w in (u, v)]
    np.testing.assert_allclose(there * areas[0], back * areas[1], rtol=1e-14)
    np.testing.assert_allclose(f(u, v, 1.0), f(v, u, 1.0), rtol=1e-14)


def test_the_base_is_bare_hidden_or_lit_through_the_layer():
    assert base_attenuation(0.4, 0.8, 0.0, 0.7, 0.5) == 1
    assert base_attenuation(0.4, 0.8, 1e4, 0.7, 0.5) == 0
    np.testing.assert_allclose(base_attenuation(0.4, 0.8, 0.3, 1.0, 1.0), escape(0.8, 0.3))
    black = base_attenuation(0.4, 0.8, 0.3, 0.0, 1.0)
    np.testing.assert_allclose(black, np.exp(-0.3 / 0.4 - 0.3 / 0.8), rtol=1e-15)


def test_a_spread_of_nine_tenths_is_what_the_talk_says():
    assert round(float(roughness_from_spread(0.9)), 2) == 0.95
    assert round(float(asymmetry_from_spread(0.9)), 12) == -0.1
    assert roughness_from_spread(1.0) == 1
    assert asymmetry_from_spread(1.0) == 0


def test_derivatives_are_finite_up_to_grazing():
    gradient = jax.jit(jax.grad(layer_brdf, (0, 1, 2, 3, 4)))
    shadow = jax.jit(jax.grad(base_attenuation, (0, 1, 2, 3, 4)))
    for cos_u in (1e-9, 0.5, 1.0):
        for density in (0.0, 1e-9, 0.5):
            assert np.isfinite(gradient(0.3, cos_u, 1e-6, density, 0.4)).all()
            assert np.isfinite(shadow(cos_u, 1e-6, density, 0.4, 0.6)).all()
    wrapped = jax.grad(wrapped_cosine)(jnp.array(-0.2))
    assert np.isfinite(wrapped)


@pytest.mark.slow
def test_the_rule_of_the_hemisphere_is_as_good_as_it_says():
    points = materials(0, 64)
    fine = functools.partial(layer_response, step=1 / 20, azimuths=320)
    assert np.abs(layers(*points) - batched(fine, 8)(*points)).max() < RULE


def test_isotropic_fibres_reflect_half_of_g():
    """With p = 1/4π the layer's radiance in uniform light is G/2."""
    points = materials(1, 8)
    points[0] = 1.0
    values = layers(*points) @ UNIFORM
    exact = [float(exact_g(d, np.cos(theta))) / 2 for d, theta in points[2:4].T]
    np.testing.assert_allclose(values, exact, atol=RULE)


def test_the_light_that_reaches_the_base_is_that_of_q_and_of_p_s():
    points = materials(2, 8)
    unscattered, scattered = (part @ UNIFORM / np.pi for part in bases(*points[:3]))
    q = np.array([float(exact_q(d)) for d in points[2]])
    np.testing.assert_allclose(unscattered, q, atol=RULE)
    assert np.all(scattered > 0)
    assert np.all(scattered < 1 - q)


def test_the_layers_albedo_is_that_of_sampled_reflections():
    """Visible normals, reflections and the density of both, against the rule: five errors."""

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


def test_no_light_leaves_with_more_than_it_brought():
    """White fibres over a white base: the layer, and layer and base, for every light."""
    points = materials(4, 32)
    alpha, theta_f, density, theta_u, phi = points
    passing = np.asarray(penetration_of(np.cos(theta_u), density))
    down = fractions(alpha, theta_f, theta_u, phi)
    layer = albedos(*points)
    assert np.all(layer <= (1 - passing) * (1 - down) + RULE)
    through = (passing + (1 - passing) * down) * [float(exact_q(d)) for d in density]
    assert np.all(layer + through <= 1 + RULE)


penetration_of = jax.vmap(penetration)


def test_in_uniform_light_a_view_may_gain_a_little():
    """Where the model does break energy: p is normalised over views, not over lights.

    At a grazing view g = 1, and the layer's radiance is ∫ p(u, v) dω_u: the mean of σ(v)/σ(u) over
    reflections of v, as p(u, v) σ(u) = p(v, u) σ(v).
    """
    alpha, fiber, view = 0.075, fiber_direction(0.74), direction(np.pi / 2, np.pi)
    root = fiber_root(fiber, alpha)

    def ratio(point):
        light = sample_phase_function(root, view, point)
        areas = [fiber_projected_area(w @ fiber, alpha) for w in (view, light)]
        return jnp.where(light[2] > 0, areas[0] / areas[1], 0.0)

    middle = (np.arange(512) + 0.5) / 512
    points = np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2)
    gain = jax.jit(jax.vmap(ratio))(points).mean() - 1
    assert 5e-4 < gain < 2e-3


def test_the_harmonics_are_orthonormal_and_their_hemispheres_known():
    directions, weights = hemisphere_rule()
    values = np.asarray(jax.vmap(harmonics)(directions))
    # Y(−ω) = ±Y(ω): the other half of the sphere
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


@pytest.mark.slow
def test_the_ambient_model_is_exact_for_isotropic_fibres_in_uniform_light():
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


@pytest.mark.parametrize(("wrap", "power"), [(0.2, 2)])
def test_wrapped_light_is_as_much_as_unwrapped(wrap, power):
    y, weights = np.polynomial.legendre.leggauss(32)
    cosine = (y * (1 + wrap) + 1 - wrap) / 2
    lit = jax.vmap(lambda c: wrapped_cosine(c, wrap, power))(cosine)
    np.testing.assert_allclose(np.sum(weights * lit) * np.pi * (1 + wrap), np.pi, rtol=1e-13)
    assert wrapped_cosine(-wrap - 0.01, wrap, power) == 0
    np.testing.assert_allclose(wrapped_cosine(0.3, 0.0, 1), 0.3, rtol=1e-15)


def test_the_deferred_version_goes_from_lambert_to_fuzz():
    light, view = direction(1.0, 0.5), direction(0.6, 2.0)
    albedo = np.array([0.1, 0.05, 0.02])
    bare, half, full = (deferred_radiance(light, view, albedo, f) for f in (0.0, 0.5, 1.0))
    np.testing.assert_allclose(bare, albedo * np.cos(1.0) / np.pi, rtol=1e-15)
    np.testing.assert_allclose(half, (bare + full) / 2, rtol=1e-15)
    phase = fiber_phase_function(light, view, direction(0.0, 0.0), np.sqrt(0.9))
    fuzz = layer_brdf(phase, light[2], view[2], 0.5, 5 * albedo) * wrapped_cosine(light[2])
    np.testing.assert_allclose(full, fuzz, rtol=1e-14)
    dusk = deferred_radiance(direction(1.65, 0.5), view, albedo, 1.0)
    assert np.all(dusk > 0)
    assert np.all(deferred_radiance(direction(1.8, 0.5), view, albedo, 1.0) == 0)
