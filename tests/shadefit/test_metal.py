"""The sphere of rough metal: what it returns in a furnace, and what it sees."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shadefit.render.metal import Metal, metal_sphere, surroundings
from shadefit.render.shade import BACKDROP

WHITE = Metal(0.8, (1.0, 1.0, 1.0))


def furnace(_towards):
    return jnp.ones(3)


@pytest.mark.slow
def test_white_metal_returns_a_furnace_with_all_scattering_only():
    image = metal_sphere(WHITE, size=12, samples=512, environment=furnace)
    seen = ~np.all(image == BACKDROP, axis=-1)
    assert 60 < seen.sum() < 144
    # The noise of 512 samples; the rim is the least sure.
    assert np.max(abs(image[seen] - 1)) < 0.06
    assert abs(np.mean(image[seen]) - 1) < 3e-3
    single = metal_sphere(WHITE, size=12, samples=512, multiple=False, environment=furnace)
    assert np.mean(single[seen]) < 0.75


@pytest.mark.slow
def test_images_are_the_same_each_time():
    first, second = (metal_sphere(WHITE, size=8, samples=32) for _ in range(2))
    assert np.array_equal(first, second)


def test_surroundings_are_brightest_towards_the_first_lamp():
    lamp = np.array([-0.55, -0.5, 0.75])
    lamp /= np.linalg.norm(lamp)
    at = jax.jit(jax.vmap(surroundings))
    directions = np.array([lamp, [0, 0, 1], [0, 0, -1], [1, 0, 0]], float)
    radiance = np.asarray(at(directions)).sum(axis=1)
    assert np.argmax(radiance) == 0
    assert np.all(radiance > 0)
