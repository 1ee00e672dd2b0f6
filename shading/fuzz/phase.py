"""The two phase functions of the fuzz layer: SGGX fibres and velvet."""

import jax.numpy as jnp
from jax import Array

from shading.phase import half_vector, schlick_phase_function
from shading.sggx import fiber_normal_distribution, fiber_projected_area
from shading.types import Scalar, Vector


def fiber_phase_function(light: Vector, view: Vector, fiber: Vector, alpha: Scalar) -> Array:
    """Return the phase function of a fibre, p_F(u, v) = D_F(h) / (4 σ_F(u)), per steradian.

    `light` u, `view` v and `fiber` t are unit vectors with u + v ≠ 0. `alpha` in (0, 1] is the
    projected area along t. The function is not symmetric, but p_F(u, v) σ_F(u) = p_F(v, u) σ_F(v).
    """
    light, fiber = jnp.asarray(light), jnp.asarray(fiber)
    cos_ht = half_vector(light, view) @ fiber
    area = fiber_projected_area(light @ fiber, alpha)
    return fiber_normal_distribution(cos_ht, alpha) / (4 * area)


def velvet_lobe(asymmetry: Scalar, cos_ht: Scalar) -> Array:
    """Return p_Schlick(k, −sin(t, h)), the velvet phase function before normalisation.

    `asymmetry` k is in (−1, 0]. `cos_ht` is h·t, where h is the unit vector along u + v and t is
    the fibre. The sine replaces u·v in Schlick's function. u and v point outwards, so the sign is
    negative. With a positive sign and k < 0 the lobe would lie along the fibre (docs/brdf.md).
    The sine has a kink at h = ±t. The derivative there is set to zero, the mean of the two sides.
    """
    cos2 = jnp.asarray(cos_ht) ** 2
    sine = jnp.where(cos2 < 1, jnp.sqrt(1 - jnp.where(cos2 < 1, cos2, 0.0)), 0.0)
    return schlick_phase_function(asymmetry, -sine)


def velvet_phase_function(asymmetry: Scalar, cos_ht: Scalar, normalisation: Scalar) -> Array:
    """Return the velvet phase function p_V(k, h, t) = r(k) p_Schlick(k, −sin(t, h)), per steradian.

    `asymmetry` k is in (−1, 0] and `cos_ht` is h·t. `normalisation` is the factor r.
    `integrals.VELVET` gives the largest r that creates no energy for any direction of light.
    """
    return jnp.asarray(normalisation) * velvet_lobe(asymmetry, cos_ht)
