"""The phase functions of the fuzz layer: SGGX fibres, their reciprocal version, and velvet."""

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


def reciprocal_scale(cos_t: Scalar, alpha: Scalar) -> Array:
    """Return s(ω·t; α), the scale of `reciprocal_phase_function`, by a fit.

    `cos_t` is ω·t and `alpha` in (0, 1]. With σ² = 1 − κ(ω·t)² and q = α²/σ² the value is
    s⁴ = σ²/(1 + (1 − α)(k₀q + k₁q² + k₂α + k₃αq + k₄α²)). It is exact at α = 1, and for ω·t ≠ ±1
    as α → 0. For α ≥ 0.05 it is within 1.4 % of the exact one (`integrals.fuzz.phase_scale`).
    """
    alpha = jnp.asarray(alpha)
    area2 = 1 - jnp.asarray(cos_t) ** 2 * (1 - alpha) * (1 + alpha)
    ratio = alpha * alpha / area2
    k0, k1, k2, k3, k4 = _SCALE
    change = ratio * (k0 + k1 * ratio + k3 * alpha) + alpha * (k2 + k4 * alpha)
    return jnp.sqrt(jnp.sqrt(area2 / (1 + (1 - alpha) * change)))


# The largest relative error of s⁻⁴ for α in [0.05, 1] is the least possible
# (tests/shading/test_reciprocal_phase.py).
_SCALE = (0.5926, 1.6056, 0.5494, 2.2452, -4.6907)


def reciprocal_phase_function(light: Vector, view: Vector, fiber: Vector, alpha: Scalar) -> Array:
    """Return D_F(h) / (4 s(u·t) s(v·t)), per steradian. It is symmetric: p(u, v) = p(v, u).

    The arguments are those of `fiber_phase_function`, which it can replace in `layer_brdf`. With
    the exact s its integral over v is one for all u. With that of `reciprocal_scale` it is between
    0.977 and 1.018 for α ≥ 0.05. P_s, G, Q and R of this project belong to `fiber_phase_function`.
    """
    light, view, fiber = jnp.asarray(light), jnp.asarray(view), jnp.asarray(fiber)
    cos_ht = half_vector(light, view) @ fiber
    scales = reciprocal_scale(light @ fiber, alpha) * reciprocal_scale(view @ fiber, alpha)
    return fiber_normal_distribution(cos_ht, alpha) / (4 * scales)


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
