"""The radiance of a scene's points: the fuzz BRDF with any table's P_s, G, Q and R."""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from shadefit.render.functions import functions
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

# Least cosine of view and normal: at the very rim nothing has a limit.
_LEAST_COSINE = 1e-3
# The sky is a polynomial of the height above the horizon: zenith, horizon, ground.
SKY = ((0.55, 0.70, 1.0), (0.95, 0.92, 0.88), (0.22, 0.19, 0.17))
SUN = (1.0, 0.93, 0.82)
BACKDROP = (0.60, 0.62, 0.66)
_BATCH = 1 << 14
# √(v·n) where G is tabulated: between them it is linear to 1e-5 (tests/test_render.py).
_ROOTS = np.linspace(np.sqrt(_LEAST_COSINE), 1, 2049)


class Material(NamedTuple):
    """The layer and the base: density, spread, tilt θf in radians, and linear RGB albedos."""

    density: float
    spread: float
    tilt: float
    fiber: tuple[float, float, float]
    base: tuple[float, float, float]


class Light(NamedTuple):
    """The sun's unit direction and irradiance, the sky's radiance: factors of `SUN` and `SKY`."""

    direction: tuple[float, float, float]
    sun: float
    sky: float


def render(
    scene: Scene, hits: Hits, material: Material, light: Light, name: str, azimuths: np.ndarray
) -> np.ndarray:
    """Give the linear radiance (n, 3) of a scene's samples, `BACKDROP`'s where nothing is seen.

    `azimuths` (n,) turn the fibres about the normal, in radians. The ambient model takes the place
    of an integral over the sky.
    """
    sunlit = scene.sunlit(hits.position, np.array(light.direction))
    averages = _averages(name, material)
    columns = (hits.normal, hits.comb, hits.view, hits.open_sky, azimuths, sunlit)
    shaded = _in_batches(lambda part: _shade(name, part, material, light, averages), columns)
    return np.where(hits.seen[:, None], shaded, BACKDROP)


def tabulated(values: Array, cos_v: Array) -> Array:
    """Interpolate between values at `_ROOTS`², linearly in √(v·n)."""
    at = (jnp.sqrt(cos_v) - _ROOTS[0]) / (_ROOTS[1] - _ROOTS[0])
    below = jnp.clip(jnp.floor(at), 0, len(_ROOTS) - 2).astype(int)
    share = at - below
    return (1 - share) * values[below] + share * values[below + 1]


def _in_batches(function: Callable, columns: tuple) -> np.ndarray:
    """Apply a vectorised function to batches of one size, so that it is compiled once."""
    count = len(columns[0])
    filled = [x[np.minimum(np.arange(count + -count % _BATCH), count - 1)] for x in columns]
    starts = range(0, len(filled[0]), _BATCH)
    parts = [function([x[i : i + _BATCH] for x in filled]) for i in starts]
    return np.concatenate([np.asarray(part) for part in parts])[:count]


@functools.partial(jax.jit, static_argnums=0)
def _averages(name: str, material: Material) -> tuple[Array, Array, Array]:
    """Give what is constant for a material: G at `_ROOTS`² (nodes,), Q and R."""
    chosen, alpha = functions(name), roughness_from_spread(material.spread)
    g = jax.vmap(chosen.g, (None, 0))(material.density, _ROOTS**2)
    return g, chosen.q(material.density), chosen.r(alpha, material.tilt)


def sky_coefficients() -> np.ndarray:
    """Give the nine harmonics (9, 3) of the sky: a + b z + c z² through `SKY`'s three colours."""
    zenith, horizon, ground = (np.array(colour) for colour in SKY)
    a, b, c = horizon, (zenith - ground) / 2, (zenith + ground) / 2 - horizon
    light = np.zeros((9, 3))
    light[0] = (a + c / 3) * np.sqrt(4 * np.pi)
    light[2] = b * np.sqrt(4 * np.pi / 3)
    light[6] = c * (2 / 3) * np.sqrt(4 * np.pi / 5)
    return light


@functools.partial(jax.jit, static_argnums=0)
def _shade(name, columns, material, light, averages):
    chosen, sky = functions(name), sky_coefficients()

    def shade(*point):
        return _point(chosen, sky, *point, material, light, averages)

    return jax.vmap(shade)(*columns)


def _point(chosen, sky, normal, comb, view, open_sky, azimuth, lit, material, light, averages):
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
    # Both at once, because a second copy of P_s takes as long again to compile.
    fraction = jax.vmap(chosen.ps, (0, 0, None, None, None))
    along = jnp.stack([sun @ fiber, view @ fiber])
    down, scattered = fraction(
        jnp.stack([cos_u, cos_v]), along, cos_nt, alpha, jnp.asarray(material.tilt)
    )
    base = base_attenuation(cos_u, cos_v, material.density, fiber_albedo, down) * base_albedo
    direct = (layer + base / jnp.pi) * jnp.where(above > 0, cos_u, 0.0) * light.sun * lit

    mean, received = mean_radiance(sky, normal), irradiance(sky, normal)
    glow = ambient_layer(mean, fiber_albedo, tabulated(g, cos_v), scattered)
    shadow = ambient_attenuation(cos_v, material.density, fiber_albedo, q, r)
    ambient = ambient_radiance(glow, shadow, base_albedo, received) * light.sky * open_sky
    return direct * jnp.asarray(SUN) + ambient
