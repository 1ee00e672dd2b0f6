"""The simplified fuzz BRDF of the deferred renderer.

All parameters but the base's albedo are constants, and one weight (the fuzziness) blends the fuzz
with a Lambertian base. The fibre is along the normal, and the layer casts no shadow on the base.
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

# Wrapped light also reaches points where u·n ≤ 0. The BRDF of the layer is evaluated there with
# this u·n instead.
_LEAST_COSINE = 1e-3


def wrapped_cosine(cosine: Scalar, wrap: Scalar = WRAP, power: int = WRAP_POWER) -> Array:
    """Return the wrapped cosine, which replaces the clamped cosine max(u·n, 0).

    It is (1 + n) / (2 (1 + w)) (max(u·n + w, 0) / (1 + w))ⁿ. `cosine` is u·n in [−1, 1], `wrap` is
    w ≥ 0 and `power` is n ≥ 1. Its integral over the sphere is π, as that of the clamped cosine
    (McAuley 2013).
    """
    w = jnp.asarray(wrap)
    lit = jnp.maximum(jnp.asarray(cosine) + w, 0) / (1 + w)
    return (1 + power) / (2 * (1 + w)) * lit**power


def deferred_radiance(
    light: Vector, view: Vector, albedo: Colour, fuzziness: Scalar, radiance: Colour = 1.0
) -> Array:
    """Return the radiance lerp(L_Lambert, L_fuzz, fuzziness) in directional light.

    The normal and the fibre are (0, 0, 1). `light` u and `view` v are unit vectors with v·n > 0.
    `albedo` is that of the Lambertian base. The albedo of the fibres is five times as large.
    `fuzziness` is in [0, 1]. `radiance` is the irradiance on a plane across the light's direction.

    Two things are inferred: the wrapped cosine replaces the u·n of the rendering equation for the
    fuzz only, and the u·n within the BRDF of the layer is at least 0.001.
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
