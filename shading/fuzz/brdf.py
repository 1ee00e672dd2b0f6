"""The anisotropic asperity-scattering ("fuzz") BRDF: a layer of fibres over a base.

A single-scattering layer after Koenderink and Pont, of density d, albedo c_f and any phase function
p, shadows the base below it. Directions u (light) and v (view) point away from the surface; the
arguments are their cosines with its normal. Albedos and radiances are scalars or colours, (3,).
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Real

from shading.fuzz.layer import optical_path, penetration
from shading.types import Scalar

Colour = Real[ArrayLike, "..."]


def layer_brdf(
    phase: Scalar, cos_u: Scalar, cos_v: Scalar, density: Scalar, albedo: Colour
) -> Array:
    """Give f(u, v) = c_f p(u, v) (1 − exp(−d (u+v)·n / ((u·n)(v·n)))) / ((u+v)·n), per steradian.

    `phase` is p(u, v), per steradian; `cos_u` = u·n and `cos_v` = v·n in (0, 1]; `density` d ≥ 0;
    `albedo` c_f of the fibres, in [0, 1].
    """
    path = optical_path(density, cos_u) + optical_path(density, cos_v)
    kernel = -jnp.expm1(-path) / (jnp.asarray(cos_u) + jnp.asarray(cos_v))
    return jnp.asarray(albedo) * phase * kernel


def escape(cos_v: Scalar, density: Scalar) -> Array:
    """Give P_e = exp(−d/(v·n)), the chance that light reflected by the base leaves the layer."""
    return penetration(cos_v, density)


def base_attenuation(
    cos_u: Scalar, cos_v: Scalar, density: Scalar, albedo: Colour, scattered: Scalar
) -> Array:
    """Give c_atten(u, v) = [P_p(u) + c_f (1 − P_p(u)) P_s(u)] P_e(v), a factor of the base's BRDF.

    `scattered` is P_s(u), the fraction of the scattered light that goes down.
    """
    penetrating = penetration(cos_u, density)
    return (penetrating + jnp.asarray(albedo) * (1 - penetrating) * scattered) * escape(
        cos_v, density
    )


def roughness_from_spread(spread: Scalar) -> Array:
    """Give α = √spread, the projected area along the fibre, for a spread in (0, 1].

    An inference: the talk says that a spread of 0.9 is α ≈ 0.95, and no more (docs/brdf.md).
    """
    return jnp.sqrt(jnp.asarray(spread))


def asymmetry_from_spread(spread: Scalar) -> Array:
    """Give k = spread − 1, the asymmetry of the velvet lobe, for a spread in (0, 1].

    An inference: the talk says that a spread of 0.9 is k ≈ −0.1, and no more (docs/brdf.md).
    """
    return jnp.asarray(spread) - 1
