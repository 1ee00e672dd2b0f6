"""A sphere of rough metal under a sky, a sun and two lamps: single scattering, and all of it.

The light is drawn, so the image has noise. Each sample draws a visible normal for single
scattering, and a cosine-weighted light for f_ms, which is nearly diffuse.
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.microfacet import average_albedo, directional_albedo, schlick_average
from integrals.monte_carlo import unit_points
from shadefit.render.scenes import SCENES
from shadefit.render.shade import BACKDROP, SKY
from shading import reflect, visible_normal
from shading.microfacet import color_of_walk, projected_roughness_at, schlick

# E is interpolated between the squares of these roots of μ, with an error below 1e-4.
_ROOTS = np.linspace(0.0, 1.0, 257)
# Directions (to be normalised), widths, and radiances at the centre of three soft lamps. The
# radiance falls like exp(−(1 − cos θ)/width). Small bright lamps would make the image noisy.
_LAMPS = (
    ((-0.55, -0.5, 0.75), 0.02, (4.5, 4.2, 3.7)),
    ((0.9, -0.35, 0.35), 0.03, (1.4, 1.8, 2.3)),
    ((0.1, 0.9, 0.5), 0.04, (1.9, 1.7, 1.4)),
)
_CHECKS = 1.4


class Metal(NamedTuple):
    """The width α of GGX, and the reflectance at normal incidence in linear RGB."""

    alpha: float
    reflectance: tuple[float, float, float]


def surroundings(towards: Array) -> Array:
    """Return the linear radiance (3,) from a unit direction: sky, chequered ground and lamps."""
    zenith, horizon, ground = (jnp.array(colour) for colour in SKY)
    height = towards[2]
    sky = horizon + (zenith - horizon) * jnp.sqrt(jnp.maximum(height, 0.0))
    depth = jnp.maximum(-height, 1e-3)
    cells = jnp.floor(towards[0] / depth * _CHECKS) + jnp.floor(towards[1] / depth * _CHECKS)
    contrast = jnp.exp(-0.15 / depth)
    checked = ground * (1 + contrast * jnp.where(cells % 2 == 0, 0.9, -0.7))
    radiance = jnp.where(height > 0, sky, checked)
    for direction, width, colour in _LAMPS:
        axis = np.array(direction) / np.linalg.norm(direction)
        radiance = radiance + jnp.exp((towards @ axis - 1) / width) * jnp.array(colour)
    return radiance


def metal_sphere(
    metal: Metal,
    *,
    size: int = 128,
    samples: int = 128,
    multiple: bool = True,
    seed: int = 0,
    environment: Callable[[Array], Array] = surroundings,
) -> np.ndarray:
    """Return the linear radiance (size, size, 3) of a sphere of metal.

    Each pixel averages `samples` lights of each kind of scattering, 32 times a power of two.
    Without `multiple` there is single scattering only. E and E_avg are exact. `environment` maps a
    unit direction to the radiance (3,) that comes from there.
    """
    hits = SCENES["sphere"].hits(size)
    table, average = _albedos(metal.alpha)
    numbers = unit_points(samples, 4, "sobol", seed).reshape(samples, 4)
    # One set of numbers is shifted from pixel to pixel, so that the noise is not a pattern.
    shifts = np.random.default_rng(seed + 1).random((size * size, 4))
    rows = [
        np.asarray(_row(environment, *part, numbers, metal, table, average, float(multiple)))
        for part in zip(
            *(np.split(each, size) for each in (hits.normal, hits.view, shifts)), strict=True
        )
    ]
    image = np.where(hits.seen[:, None], np.concatenate(rows), BACKDROP)
    return image.reshape(size, size, 3)


@jax.jit
def _albedos(alpha) -> tuple[Array, Array]:
    """Return E at `_ROOTS`², and E_avg."""
    table = jax.vmap(lambda root: directional_albedo(root * root, alpha).value)(_ROOTS)
    return table, average_albedo(alpha).value


@functools.partial(jax.jit, static_argnums=0)
def _row(environment, normals, views, shifts, numbers, metal, table, average, multiple):
    def pixel(normal, view, shift):
        each = (numbers + shift) % 1.0
        values = jax.vmap(
            lambda u: _radiance(environment, normal, view, u, metal, table, average, multiple)
        )
        return jnp.mean(values(each), axis=0)

    return jax.vmap(pixel)(normals, views, shifts)


def _radiance(environment, normal, view, numbers, metal, table, average, multiple) -> Array:
    alpha, f0 = metal.alpha, jnp.asarray(metal.reflectance)
    frame = _frame(normal)
    local = frame @ view
    local = local.at[2].set(jnp.maximum(local[2], 1e-4))

    facet = visible_normal(jnp.diag(jnp.array([alpha, alpha, 1.0])), local, numbers[:2])
    light = reflect(local, facet)
    nu, sigma = jnp.maximum(light[2], 0.0), projected_roughness_at(local[2], alpha)
    across = local[2] * projected_roughness_at(nu, alpha) + nu * sigma
    weight = 2 * nu * sigma / across
    cosine = jnp.clip(local @ facet, 0.0, 1.0)
    fresnel = jax.vmap(schlick, (None, 0))(cosine, f0)
    single = fresnel * weight * environment(light @ frame)

    height = jnp.sqrt(numbers[2])
    level, angle = jnp.sqrt(1 - numbers[2]), 2 * jnp.pi * numbers[3]
    diffuse = jnp.stack([level * jnp.cos(angle), level * jnp.sin(angle), height])
    missing = (1 - _albedo(table, local[2])) * (1 - _albedo(table, height)) / (1 - average)
    color = jax.vmap(color_of_walk, (0, None))(jax.vmap(schlick_average)(f0), average)
    return single + multiple * color * missing * environment(diffuse @ frame)


def _albedo(table: Array, cosine: Array) -> Array:
    return jnp.interp(jnp.sqrt(cosine), _ROOTS, table)


def _frame(normal: Array) -> Array:
    """Return a matrix (3, 3) that takes directions to a frame in which z is the normal."""
    x, y, z = normal
    sign = jnp.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    return jnp.stack(
        [
            jnp.stack([1 + sign * x * x * a, sign * x * y * a, -sign * x]),
            jnp.stack([x * y * a, sign + y * y * a, -y]),
            normal,
        ]
    )
