"""The models of the layer in ambient light: their weights, symmetries, limits and code."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals import PS, G
from programs.functions import Parameter, function
from programs.program import evaluate
from programs.tracing.tracer import trace
from shading import AMBIENT_MODELS, LayerLight, LayerView, harmonics, layer_radiance, light_weights
from tests.batches import batched
from tests.integrals.problems import awkward_points

NORMAL = np.array([0.0, 0.0, 1.0])
NAMES = tuple(AMBIENT_MODELS)


@functools.cache
def compiled(name):
    return jax.jit(jax.vmap(AMBIENT_MODELS[name]))


def light_of(name, view) -> LayerLight:
    count = len(view.alpha)
    found = compiled(name)(view)
    return LayerLight(*(np.broadcast_to(np.asarray(each), count) for each in found))


@functools.cache
def materials(count=300, least=0.05):
    """Return a view (count,) with exact G and P_s."""
    alpha, theta_f, theta_v, phi = awkward_points(31, count, least)
    density = np.random.default_rng(31).uniform(0.01, 0.8, count)
    sine = np.sin(theta_v)
    v = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta_v)], axis=1)
    t = np.stack([np.sin(theta_f), 0 * theta_f, np.cos(theta_f)], axis=1)
    scattered = batched(PS.value, 64)(alpha, theta_f, theta_v, phi)
    scattering = batched(G.value, 64)(density, np.maximum(v[:, 2], 1e-3))
    cosines = v[:, 2], np.sum(v * t, axis=1), t[:, 2]
    return LayerView(*cosines, alpha, density, scattering, scattered)


def test_weights_are_mean_harmonics():
    """The weights of light from one direction u, with R = u and mean square u uᵀ, are M0 Yᵢ(u)."""
    u = np.array([0.48, -0.6, 0.64])
    along = dict(zip(("along_normal", "along_view", "along_fiber"), u, strict=True))
    light = LayerLight(0.7, **along, about_mean=1.0)
    weights = light_weights(light, *np.eye(3))
    # The frame n, v, t is that of x, y, z here.
    np.testing.assert_allclose(weights, 0.7 * np.asarray(harmonics(u)), rtol=0, atol=1e-15)
    each = LayerLight(1.0, about_normal=0.3, about_view=-0.2, about_fiber=0.5)
    expected = sum(
        s * np.asarray(harmonics(e)) for s, e in zip((0.3, -0.2, 0.5), np.eye(3), strict=True)
    )
    np.testing.assert_allclose(light_weights(each, *np.eye(3))[4:], expected[4:], atol=1e-15)


def test_radiance_of_colours_is_linear_and_not_negative():
    light = LayerLight(0.5, 0.4, 0.1, -0.2, 1.1, about_fiber=-0.1)
    n, v, t = NORMAL, np.array([0.6, 0, 0.8]), np.array([0, 0.6, 0.8])
    colours = np.random.default_rng(2).normal(size=(9, 3))
    weights = np.asarray(light_weights(light, n, v, t))
    np.testing.assert_allclose(
        layer_radiance(light, colours, n, v, t), np.maximum(weights @ colours, 0), atol=1e-15
    )
    uniform = np.zeros(9)
    uniform[0] = np.sqrt(4 * np.pi)
    assert abs(layer_radiance(light, uniform, n, v, t) - 0.5) < 1e-15
    assert layer_radiance(light, -uniform, n, v, t) == 0


@pytest.mark.parametrize("name", NAMES)
def test_even_in_the_fibre(name):
    view = materials()
    one = light_of(name, view)
    other = light_of(name, view._replace(cos_vt=-view.cos_vt, cos_nt=-view.cos_nt))
    other = other._replace(along_fiber=-other.along_fiber)
    for here, there in zip(one, other, strict=True):
        np.testing.assert_allclose(here, there, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("name", [name for name in NAMES if not name.startswith("cheap")])
def test_isotropic_fibres_in_uniform_light(name):
    """At α = 1 half of the light that is scattered goes up, so M0 = G/2."""
    view = materials()
    view = view._replace(alpha=np.ones_like(view.alpha), scattered=np.full_like(view.alpha, 0.5))
    np.testing.assert_allclose(light_of(name, view).level, view.scattering / 2, rtol=1e-13)


@pytest.mark.parametrize("name", NAMES)
def test_code_is_that_of_the_function(name):
    """Every model can be written as shader code, which has the same values."""
    model = AMBIENT_MODELS[name]

    def call(*values):
        rest = dict.fromkeys(LayerView._fields, 0.5)
        return tuple(
            jnp.asarray(each, float) + 0.0
            for each in model(LayerView(**rest | dict(zip(model.arguments, values, strict=True))))
        )

    parameters = [Parameter(each, (0.0, 1.0)) for each in model.arguments]
    program = trace(function("Moments", parameters, call, result=len(LayerLight._fields)))
    view = materials(50)
    found = evaluate(program, np.stack([getattr(view, each) for each in model.arguments], axis=1))
    expected = np.stack(light_of(name, view), axis=1)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
