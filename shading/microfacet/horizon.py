"""The horizon in the space where the ellipsoid of GGX is a sphere: what caps must not cut off.

M⁻¹ = diag(1/αx, 1/αy, 1) takes the normals of GGX to those of a sphere, and the view o to ẑ = Mo/σ.
A normal m that reflects o to i there reflects ẑ to δ. A cap sampler draws δ uniformly above a
height.
"""

import jax.numpy as jnp
from jax import Array

from shading.microfacet.ggx import Roughness, projected_roughness
from shading.microfacet.reflection_cone import components
from shading.types import Scalar, Vector


def horizon_bound(view: Vector, alpha: Roughness, longitude: Scalar) -> Array:
    """Return k(φ) = 1 − T/X, with which reflections on the horizon have the height δ_z = −k(φ) ẑ_z.

    T = |i + o|², X = |M⁻¹(i + o)|², and i is the direction on the horizon with the azimuth φ =
    `longitude` in radians. A bounded cap is right if its k is at least k(φ) for all φ.
    """
    x, y, z, alpha_x, alpha_y = components(view, alpha)
    sum_x, sum_y = x + jnp.cos(longitude), y + jnp.sin(longitude)
    length2 = 2 * (1 + x * jnp.cos(longitude) + y * jnp.sin(longitude))
    return 1 - length2 / ((sum_x / alpha_x) ** 2 + (sum_y / alpha_y) ** 2 + z * z)


def horizon_height(view: Vector, alpha: Roughness, longitude: Scalar) -> Array:
    """Return δ_z = −k(φ) ẑ_z of the reflection on the horizon at the azimuth φ = `longitude`."""
    sigma = projected_roughness(view, alpha)
    return -jnp.asarray(view)[2] / sigma * horizon_bound(view, alpha, longitude)
