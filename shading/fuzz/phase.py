"""Phase functions: of SGGX distributions, of fibres, Schlick's, and the talk's velvet."""

import jax.numpy as jnp
from jax import Array

from shading.sggx import (
    fiber_normal_distribution,
    fiber_projected_area,
    normal_distribution,
    projected_area,
)
from shading.types import Matrix, Scalar, Vector


def half_vector(light: Vector, view: Vector) -> Array:
    """Give the unit vector h along u + v ≠ 0."""
    between = jnp.asarray(light) + jnp.asarray(view)
    return between / jnp.linalg.norm(between)


def phase_function(matrix: Matrix, light: Vector, view: Vector) -> Array:
    """Give p(u, v) = D(h) / (4 σ(u)), per steradian; it integrates to one over the sphere of v.

    `light` u and `view` v are unit vectors with u + v ≠ 0; h is the unit vector along u + v.
    """
    density = normal_distribution(matrix, half_vector(light, view))
    return density / (4 * projected_area(matrix, light))


def fiber_phase_function(light: Vector, view: Vector, fiber: Vector, alpha: Scalar) -> Array:
    """Give p_F(u, v) = D_F(h) / (4 σ_F(u)) of a fibre, per steradian.

    `light` u, `view` v and `fiber` t are unit vectors with u + v ≠ 0; `alpha` in (0, 1] is the
    projected area along t. Not symmetric: p_F(u, v) σ_F(u) = p_F(v, u) σ_F(v).
    """
    light, fiber = jnp.asarray(light), jnp.asarray(fiber)
    cos_ht = half_vector(light, view) @ fiber
    area = fiber_projected_area(light @ fiber, alpha)
    return fiber_normal_distribution(cos_ht, alpha) / (4 * area)


def schlick_phase_function(asymmetry: Scalar, cosine: Scalar) -> Array:
    """Give p_Schlick(k, cos θ) = (1 − k²) / (4π (1 − k cos θ)²), per steradian.

    Schlick's approximation of Henyey and Greenstein's. `asymmetry` k in (−1, 1) is positive for
    forward scattering; `cosine` is that of the angle between the directions of travel before and
    after: −u·v for u and v that both point away from the scatterer.
    """
    k = jnp.asarray(asymmetry)
    return (1 - k) * (1 + k) / (4 * jnp.pi * (1 - k * jnp.asarray(cosine)) ** 2)


def velvet_lobe(asymmetry: Scalar, cos_ht: Scalar) -> Array:
    """Give p_Schlick(k, −sin(t, h)), the velvet phase function before it is normalised.

    `asymmetry` k in (−1, 0], `cos_ht` = h·t of the unit vectors h along u + v and t along the
    fibre. The sine takes the place of u·v, for directions that point outwards, hence its sign: with
    +sin and k < 0 the lobe would lie along the fibre (docs/brdf.md). At h = ±t, where it has a
    kink, the derivative is the mean of those on either side, zero.
    """
    cos2 = jnp.asarray(cos_ht) ** 2
    sine = jnp.where(cos2 < 1, jnp.sqrt(1 - jnp.where(cos2 < 1, cos2, 0.0)), 0.0)
    return schlick_phase_function(asymmetry, -sine)


def velvet_phase_function(asymmetry: Scalar, cos_ht: Scalar, normalisation: Scalar) -> Array:
    """Give p_V(k, h, t) = r(k) p_Schlick(k, −sin(t, h)), per steradian.

    `asymmetry` k in (−1, 0]; `cos_ht` = h·t; `normalisation` r, of which `integrals.VELVET` is the
    largest that creates no energy for any direction of light.
    """
    return jnp.asarray(normalisation) * velvet_lobe(asymmetry, cos_ht)
