"""Sines and cosines by polynomials, against those of the C library in higher precision."""

import jax
import jax.numpy as jnp
import numpy as np

from shading.sine_and_cosine import sine_and_cosine

# Half a unit in the last place of 1, and as much again
ABSOLUTE = 2.3e-16


def test_they_are_those_of_long_double_within_a_unit_in_the_last_place():
    random = np.random.default_rng(3)
    wide = random.uniform(-1e5, 1e5, 50_000)
    near = np.arange(-40, 41) * (np.pi / 4) + random.normal(0, 1e-3, (200, 1))
    angles = np.concatenate([wide, near.ravel(), random.uniform(-7, 7, 50_000), [0.0]])
    sine, cosine = jax.vmap(sine_and_cosine)(angles)
    exact = angles.astype(np.longdouble)
    assert np.abs(np.asarray(sine) - np.sin(exact)).max() < ABSOLUTE
    assert np.abs(np.asarray(cosine) - np.cos(exact)).max() < ABSOLUTE


def test_small_angles_and_those_of_the_first_quadrants_keep_the_relative_precision_of_the_sine():
    angles = np.concatenate([np.geomspace(1e-300, 1, 3000), np.linspace(1e-9, 0.75 * np.pi, 3000)])
    sine, _ = jax.vmap(sine_and_cosine)(angles)
    exact = np.sin(angles.astype(np.longdouble))
    assert np.abs(np.asarray(sine) / exact - 1).max() < 4.5e-16
    assert [float(each) for each in sine_and_cosine(0.0)] == [0.0, 1.0]


def test_their_derivatives_are_each_other():
    angles = jnp.linspace(-7, 7, 101)
    slopes = jax.vmap(jax.jacfwd(lambda x: jnp.stack(sine_and_cosine(x))))(angles)
    np.testing.assert_allclose(slopes[:, 0], jnp.cos(angles), atol=1e-15)
    np.testing.assert_allclose(slopes[:, 1], -jnp.sin(angles), atol=1e-15)
