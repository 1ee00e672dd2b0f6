"""The anisotropic asperity-scattering ("fuzz") BRDF: a layer of fibres over a base.

The layer scatters light once (Koenderink and Pont). It has a density d, an albedo c_f and any phase
function p, and it casts shadow on the base below it. The light direction u and the view direction v
point away from the surface. The functions take their cosines with the normal. An albedo or a
radiance is a scalar or a colour (3,).
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
    """Return the BRDF of the layer, per steradian.

    f(u, v) = c_f p(u, v) (1 − exp(−d (u+v)·n / ((u·n)(v·n)))) / ((u+v)·n). `phase` is p(u, v) per
    steradian. `cos_u` = u·n and `cos_v` = v·n are in (0, 1]. `density` is d ≥ 0. `albedo` in [0, 1]
    is the albedo c_f of the fibres.
    """
    path = optical_path(density, cos_u) + optical_path(density, cos_v)
    kernel = -jnp.expm1(-path) / (jnp.asarray(cos_u) + jnp.asarray(cos_v))
    return jnp.asarray(albedo) * phase * kernel


def escape(cos_v: Scalar, density: Scalar) -> Array:
    """Return P_e = exp(−d/(v·n)), the probability that light from the base leaves the layer."""
    return penetration(cos_v, density)


def base_attenuation(
    cos_u: Scalar, cos_v: Scalar, density: Scalar, albedo: Colour, scattered: Scalar
) -> Array:
    """Return c_atten(u, v), the factor by which the layer attenuates the BRDF of the base.

    c_atten = [P_p(u) + c_f (1 − P_p(u)) P_s(u)] P_e(v). `cos_u` = u·n and `cos_v` = v·n are in
    (0, 1], `density` is d ≥ 0 and `albedo` is c_f. `scattered` is P_s(u), the fraction of the
    scattered light that goes down to the base.
    """
    penetrating = penetration(cos_u, density)
    return (penetrating + jnp.asarray(albedo) * (1 - penetrating) * scattered) * escape(
        cos_v, density
    )


def roughness_from_spread(spread: Scalar) -> Array:
    """Return α = √spread, the projected area along the fibre, for a spread in (0, 1].

    The formula is inferred. The talk only says that a spread of 0.9 means α ≈ 0.95 (docs/brdf.md).
    """
    return jnp.sqrt(jnp.asarray(spread))


def asymmetry_from_spread(spread: Scalar) -> Array:
    """Return k = spread − 1, the asymmetry of the velvet lobe, for a spread in (0, 1].

    The formula is inferred. The talk only says that a spread of 0.9 means k ≈ −0.1 (docs/brdf.md).
    """
    return jnp.asarray(spread) - 1
