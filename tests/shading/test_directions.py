"""Unit vectors, and the sine of the angle between them where the cosine rounds to one."""

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np

from shading import direction, direction_cosines, fiber_direction, sin2_between
from tests.integrals.problems import RIGHT

# Each component has about three roundings.
UNIT = 4 * np.finfo(float).eps


def test_directions_are_unit_vectors_with_the_given_angles():
    theta, phi = np.random.default_rng(0).uniform(0, np.pi, (2, 100))
    vectors = jax.vmap(direction)(theta, phi)
    np.testing.assert_allclose(jnp.linalg.norm(vectors, axis=1), 1, atol=UNIT)
    np.testing.assert_allclose(vectors[:, 2], np.cos(theta), atol=UNIT)
    np.testing.assert_allclose(np.arctan2(vectors[:, 1], vectors[:, 0]), phi, atol=1e-14)
    np.testing.assert_allclose(fiber_direction(0.0), [0, 0, 1], atol=UNIT)
    np.testing.assert_allclose(fiber_direction(RIGHT), [1, 0, 0], atol=UNIT)


def test_direction_cosines_match_the_vectors():
    theta_f, theta, phi = np.random.default_rng(2).uniform(0, np.pi, (3, 100))
    cosines = jax.vmap(direction_cosines)(theta_f, theta, np.cos(phi))
    u, t = jax.vmap(direction)(theta, phi), jax.vmap(fiber_direction)(theta_f)
    expected = [u[:, 2], jnp.sum(u * t, axis=1)]
    np.testing.assert_allclose(jnp.stack(cosines), jnp.stack(expected), atol=UNIT)


def test_sin2_between_has_full_relative_precision():
    rng = np.random.default_rng(1)
    for scale in (1.0, 1e-3, 1e-7, 1e-11):
        for opposite in (False, True):
            theta_a = RIGHT - scale * rng.random() if opposite else rng.uniform(0.2, 1.4)
            theta_b = theta_a + scale * rng.normal() if not opposite else RIGHT - scale
            phi = np.pi * opposite + scale * rng.normal()
            a, b, p = mp.mpf(theta_a), mp.mpf(theta_b), mp.mpf(phi)
            with mp.workdps(50):
                cosine = mp.cos(a) * mp.cos(b) + mp.sin(a) * mp.sin(b) * mp.cos(p)
                exact = 1 - cosine**2
            # The angle between opposite directions is π − θa − θb, so the rounding of π counts.
            allowed = 1e-14 + 4e-16 / scale * opposite
            assert abs(float(sin2_between(theta_a, theta_b, phi)) / exact - 1) < allowed
