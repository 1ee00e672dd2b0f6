"""The deferred simplification of the fuzz BRDF: fixed parameters, one weight, and wrapped light.

The fibre is along the normal, and the layer does not shadow the base.
"""

import jax.numpy as jnp
from jax import Array

from shading.directions import fiber_direction
from shading.fuzz.brdf import Colour, layer_brdf, roughness_from_spread
from shading.fuzz.phase import fiber_phase_function
from shading.types import Scalar, Vector

DENSITY = 0.5
SPREAD = 0.9
ALBEDO_RATIO = 5.0
WRAP = 0.2
WRAP_POWER = 2

# Wrapped light reaches points that it would graze or miss; the layer's BRDF is continued there.
_LEAST_COSINE = 1e-3


def wrapped_cosine(cosine: Scalar, wrap: Scalar = WRAP, power: int = WRAP_POWER) -> Array:
    """Give (1 + n) / (2 (1 + w)) (max(u·n + w, 0) / (1 + w))ⁿ, in place of max(u·n, 0).

    `cosine` is u·n in [−1, 1], `wrap` w ≥ 0, `power` n ≥ 1. Over the sphere it integrates to π, as
    the clamped cosine does (McAuley 2013).
    """
    w = jnp.asarray(wrap)
    lit = jnp.maximum(jnp.asarray(cosine) + w, 0) / (1 + w)
    return (1 + power) / (2 * (1 + w)) * lit**power


def deferred_radiance(
    light: Vector, view: Vector, albedo: Colour, fuzziness: Scalar, radiance: Colour = 1.0
) -> Array:
    """Give lerp(L_Lambert, L_fuzz, fuzziness) of a directional light, n = t = (0, 0, 1).

    `light` u and `view` v are unit vectors, v·n > 0; `albedo` is the Lambertian base's, the fibres'
    is five times it; `fuzziness` in [0, 1]; `radiance` is the light's irradiance across its
    direction. Inferred: only the fuzz is lit by the wrapped cosine, which takes the place of the
    rendering equation's u·n, and within the BRDF u·n is at least 0.001.
    """
    light, view = jnp.asarray(light), jnp.asarray(view)
    cos_u, cos_v = light[2], view[2]
    alpha = roughness_from_spread(SPREAD)
    phase = fiber_phase_function(light, view, fiber_direction(0.0), alpha)
    albedo = jnp.asarray(albedo)
    grazing = jnp.maximum(cos_u, _LEAST_COSINE)
    fuzz = layer_brdf(phase, grazing, cos_v, DENSITY, ALBEDO_RATIO * albedo)
    fuzz = fuzz * wrapped_cosine(cos_u)
    lambert = albedo / jnp.pi * jnp.maximum(cos_u, 0)
    return (lambert + (fuzz - lambert) * fuzziness) * jnp.asarray(radiance)
