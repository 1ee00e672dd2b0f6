"""The fuzz BRDF: layer, base, parameters, and the deferred version."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shading import (
    asymmetry_from_spread,
    base_attenuation,
    deferred_radiance,
    direction,
    escape,
    fiber_direction,
    fiber_phase_function,
    fiber_projected_area,
    fiber_root,
    layer_brdf,
    roughness_from_spread,
    sample_phase_function,
    scattering_kernel,
    wrapped_cosine,
)


def test_layer_brdf_is_kernel_times_phase_function_and_albedo():
    colour = np.array([0.2, 0.5, 0.9])
    brdf = layer_brdf(0.3, 0.4, 0.8, 0.2, colour)
    np.testing.assert_allclose(brdf, colour * 0.3 * scattering_kernel(0.4, 0.8, 0.2) / 0.4)


def test_thin_layer_is_linear_in_density():
    np.testing.assert_allclose(layer_brdf(0.3, 0.4, 0.8, 1e-12, 1.0), 0.3e-12 / 0.32, rtol=1e-11)


def test_layer_brdf_times_projected_area_is_reciprocal():
    fiber, u, v = fiber_direction(0.7), direction(0.4, 1.0), direction(1.2, -2.0)

    def f(u, v, alpha):
        return layer_brdf(fiber_phase_function(u, v, fiber, alpha), u[2], v[2], 0.3, 1.0)

    there, back = f(u, v, 0.3), f(v, u, 0.3)
    assert abs(there / back - 1) > 0.1
    areas = [fiber_projected_area(w @ fiber, 0.3) for w in (u, v)]
    np.testing.assert_allclose(there * areas[0], back * areas[1], rtol=1e-14)
    np.testing.assert_allclose(f(u, v, 1.0), f(v, u, 1.0), rtol=1e-14)


def test_base_attenuation_in_limiting_cases():
    assert base_attenuation(0.4, 0.8, 0.0, 0.7, 0.5) == 1
    assert base_attenuation(0.4, 0.8, 1e4, 0.7, 0.5) == 0
    np.testing.assert_allclose(base_attenuation(0.4, 0.8, 0.3, 1.0, 1.0), escape(0.8, 0.3))
    black = base_attenuation(0.4, 0.8, 0.3, 0.0, 1.0)
    np.testing.assert_allclose(black, np.exp(-0.3 / 0.4 - 0.3 / 0.8), rtol=1e-15)


def test_spread_0_9_gives_the_values_of_the_talk():
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


@pytest.mark.parametrize(("wrap", "power"), [(0.2, 2)])
def test_wrapped_cosine_integrates_to_pi(wrap, power):
    y, weights = np.polynomial.legendre.leggauss(32)
    cosine = (y * (1 + wrap) + 1 - wrap) / 2
    lit = jax.vmap(lambda c: wrapped_cosine(c, wrap, power))(cosine)
    np.testing.assert_allclose(np.sum(weights * lit) * np.pi * (1 + wrap), np.pi, rtol=1e-13)
    assert wrapped_cosine(-wrap - 0.01, wrap, power) == 0
    np.testing.assert_allclose(wrapped_cosine(0.3, 0.0, 1), 0.3, rtol=1e-15)


def test_deferred_radiance_blends_lambert_and_fuzz():
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


def test_grazing_view_gains_a_little_energy_in_uniform_light():
    """The model creates a little energy here, because p is normalised over views, not lights.

    At a grazing view g = 1, and the radiance of the layer is ∫ p(u, v) dω_u. This is the mean of
    σ(v)/σ(u) over reflections u of v, because p(u, v) σ(u) = p(v, u) σ(v).
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
