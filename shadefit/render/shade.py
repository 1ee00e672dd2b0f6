"""The radiance of a scene's samples: the fuzz BRDF in sunlight, its ambient model in skylight."""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from shadefit.render.functions import Functions
from shadefit.render.scenes import Hits, Scene
from shading import (
    ambient_attenuation,
    ambient_layer,
    ambient_radiance,
    base_attenuation,
    fiber_normal_distribution,
    fiber_projected_area,
    irradiance,
    layer_brdf,
    mean_radiance,
    roughness_from_spread,
)

# Cosines of view and light to the normal are at least this: the BRDF has no limit where both are 0.
_LEAST_COSINE = 1e-3
# Linear RGB of the sky at the zenith, at the horizon, and of the ground straight below.
SKY = ((0.55, 0.70, 1.0), (0.95, 0.92, 0.88), (0.22, 0.19, 0.17))
SUN = (1.0, 0.93, 0.82)
BACKDROP = (0.60, 0.62, 0.66)
# Samples that are shaded at once.
_BATCH = 1 << 14
# G of a material is computed at the squares of these values of √(v·n) and interpolated linearly in
# √(v·n), with an error below 1e-5 (tests/shadefit/test_render.py).
_ROOTS = np.linspace(np.sqrt(_LEAST_COSINE), 1, 2049)


class Material(NamedTuple):
    """The layer and the base: density, spread, tilt θf in radians, and two linear RGB albedos."""

    density: float
    spread: float
    tilt: float
    fiber: tuple[float, float, float]
    base: tuple[float, float, float]


class Light(NamedTuple):
    """The unit direction to the sun, and how bright sun and sky are.

    `sun` is the irradiance, in units of the colour `SUN`; `sky` multiplies the colours `SKY`.
    """

    direction: tuple[float, float, float]
    sun: float
    sky: float


def shade(
    scene: Scene,
    hits: Hits,
    material: Material,
    light: Light,
    functions: Functions,
    azimuths: np.ndarray,
) -> np.ndarray:
    """Return the linear radiance (n, 3) of a scene's samples; `BACKDROP` where they see no surface.

    `azimuths` (n,) are the angles in radians that turn the fibres about the normal. Skylight is not
    integrated: the ambient model approximates it.
    """
    sunlit = scene.sunlit(hits.position, np.array(light.direction))
    averages = _averages(functions, material)
    columns = (hits.normal, hits.comb, hits.view, hits.open_sky, azimuths, sunlit)
    shaded = _in_batches(
        lambda part: _shade_batch(functions, part, material, light, averages), columns
    )
    return np.where(hits.seen[:, None], shaded, BACKDROP)


def interpolated_g(values: Array, cos_v: Array) -> Array:
    """Return G at v·n from its values at `_ROOTS`², linearly in √(v·n)."""
    at = (jnp.sqrt(cos_v) - _ROOTS[0]) / (_ROOTS[1] - _ROOTS[0])
    below = jnp.clip(jnp.floor(at), 0, len(_ROOTS) - 2).astype(int)
    share = at - below
    return (1 - share) * values[below] + share * values[below + 1]


def _in_batches(function: Callable, columns: tuple) -> np.ndarray:
    """Apply a function to the columns, in batches of one size, so that JAX compiles it once."""
    count = len(columns[0])
    filled = [x[np.minimum(np.arange(count + -count % _BATCH), count - 1)] for x in columns]
    starts = range(0, len(filled[0]), _BATCH)
    parts = [function([x[i : i + _BATCH] for x in filled]) for i in starts]
    return np.concatenate([np.asarray(part) for part in parts])[:count]


@functools.partial(jax.jit, static_argnums=0)
def _averages(functions: Functions, material: Material) -> tuple[Array, Array, Array]:
    """Return the averages that a material needs only once: G at `_ROOTS`² (nodes,), Q and R."""
    alpha = roughness_from_spread(material.spread)
    g = jax.vmap(functions.g, (None, 0))(material.density, _ROOTS**2)
    return g, functions.q(material.density), functions.r(alpha, material.tilt)


def sky_coefficients() -> np.ndarray:
    """Return the nine harmonics (9, 3) of the sky.

    The sky's radiance is a + b z + c z², where z is the height of the direction; it has the three
    colours of `SKY` at z = 1, 0 and −1.
    """
    zenith, horizon, ground = (np.array(colour) for colour in SKY)
    a, b, c = horizon, (zenith - ground) / 2, (zenith + ground) / 2 - horizon
    light = np.zeros((9, 3))
    light[0] = (a + c / 3) * np.sqrt(4 * np.pi)
    light[2] = b * np.sqrt(4 * np.pi / 3)
    light[6] = c * (2 / 3) * np.sqrt(4 * np.pi / 5)
    return light


@functools.partial(jax.jit, static_argnums=0)
def _shade_batch(functions, columns, material, light, averages):
    sky = sky_coefficients()

    def at(*sample):
        return _shade_sample(functions, sky, *sample, material, light, averages)

    return jax.vmap(at)(*columns)


def _shade_sample(
    functions, sky, normal, comb, view, open_sky, azimuth, lit, material, light, averages
):
    alpha, (g, q, r) = roughness_from_spread(material.spread), averages
    fiber_albedo, base_albedo = jnp.asarray(material.fiber), jnp.asarray(material.base)
    across = jnp.cross(normal, comb)
    leaning = jnp.cos(azimuth) * comb + jnp.sin(azimuth) * across
    cos_nt = jnp.cos(material.tilt)
    fiber = jnp.sin(material.tilt) * leaning + cos_nt * normal
    cos_v = jnp.clip(view @ normal, _LEAST_COSINE, 1)

    sun = jnp.asarray(light.direction)
    above = sun @ normal
    cos_u = jnp.clip(above, _LEAST_COSINE, 1)
    between = sun + view
    cos_ht = between @ fiber / jnp.maximum(jnp.linalg.norm(between), 1e-6)
    phase = fiber_normal_distribution(cos_ht, alpha)
    phase = phase / (4 * fiber_projected_area(sun @ fiber, alpha))
    layer = layer_brdf(phase, cos_u, cos_v, material.density, fiber_albedo)
    # One call for light and view, because two copies of P_s would take twice as long to compile.
    fraction = jax.vmap(functions.ps, (0, 0, None, None, None))
    along = jnp.stack([sun @ fiber, view @ fiber])
    down, scattered = fraction(
        jnp.stack([cos_u, cos_v]), along, cos_nt, alpha, jnp.asarray(material.tilt)
    )
    base = base_attenuation(cos_u, cos_v, material.density, fiber_albedo, down) * base_albedo
    direct = (layer + base / jnp.pi) * jnp.where(above > 0, cos_u, 0.0) * light.sun * lit

    mean, received = mean_radiance(sky, normal), irradiance(sky, normal)
    glow = ambient_layer(mean, fiber_albedo, interpolated_g(g, cos_v), scattered)
    shadow = ambient_attenuation(cos_v, material.density, fiber_albedo, q, r)
    ambient = ambient_radiance(glow, shadow, base_albedo, received) * light.sky * open_sky
    return direct * jnp.asarray(SUN) + ambient
