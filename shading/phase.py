"""Phase functions that belong to no particular material: SGGX and Schlick's.

A phase function p(u, v) is the density, per steradian, with which light from the direction u is
scattered towards v. The phase functions of fibres and of velvet are in `shading.fuzz.phase`.
"""

import jax.numpy as jnp
from jax import Array

from shading.sggx import normal_distribution, projected_area
from shading.types import Matrix, Scalar, Vector


def half_vector(light: Vector, view: Vector) -> Array:
    """Return the unit vector h along u + v. The sum must not be zero."""
    between = jnp.asarray(light) + jnp.asarray(view)
    return between / jnp.linalg.norm(between)


def phase_function(matrix: Matrix, light: Vector, view: Vector) -> Array:
    """Return the SGGX phase function p(u, v) = D(h) / (4 σ(u)), per steradian.

    `matrix` is the SGGX matrix (3, 3). `light` u and `view` v are unit vectors with u + v ≠ 0, and
    h is the unit vector along u + v. The integral of p over the sphere of v is one.
    """
    density = normal_distribution(matrix, half_vector(light, view))
    return density / (4 * projected_area(matrix, light))


def schlick_phase_function(asymmetry: Scalar, cosine: Scalar) -> Array:
    """Return p_Schlick(k, cos θ) = (1 − k²) / (4π (1 − k cos θ)²), per steradian.

    This is Schlick's approximation of the phase function of Henyey and Greenstein. `asymmetry` k
    in (−1, 1) is positive for forward scattering. θ is the angle between the directions of travel
    before and after scattering. When u and v both point away from the scatterer, `cosine` is −u·v.
    """
    k = jnp.asarray(asymmetry)
    return (1 - k) * (1 + k) / (4 * jnp.pi * (1 - k * jnp.asarray(cosine)) ** 2)
