"""The ambient model of the fuzz BRDF: averages over the hemisphere take the place of integrals.

Light enters as its mean radiance over the hemisphere and its irradiance (`shading.harmonics`), the
material as G, Q, R and P_s, exact or fitted. docs/brdf.md measures what this costs.
"""

import jax.numpy as jnp
from jax import Array

from shading.fuzz import Colour, escape
from shading.types import Scalar


def ambient_layer(mean: Colour, albedo: Colour, scattering: Scalar, scattered: Scalar) -> Array:
    """Give the layer's radiance towards v, c_f G(d, v) (1 − P_s(v)) L̄.

    `mean` L̄ is the light's mean radiance over the hemisphere, `scattering` G(d, v) and `scattered`
    P_s(v): three averages for the average of three factors, and 1 − P_s(v) = ∫_Ω p(v, u) dω_u for
    the integral of p(u, v), as if p were symmetric.
    """
    return jnp.asarray(albedo) * scattering * (1 - jnp.asarray(scattered)) * jnp.asarray(mean)


def ambient_attenuation(
    cos_v: Scalar,
    density: Scalar,
    albedo: Colour,
    average_penetration: Scalar,
    average_scattered: Scalar,
) -> Array:
    """Give c_atten = P_e(v) [Q + c_f R (1 − Q)], the factor of the base's ambient light.

    `average_penetration` is Q(d) and `average_scattered` R(θf, α). It multiplies the base's
    diffuse radiance c_b E/π and its specular one alike.
    """
    q = jnp.asarray(average_penetration)
    down = q + jnp.asarray(albedo) * average_scattered * (1 - q)
    return escape(cos_v, density) * down


def ambient_radiance(
    layer: Colour, attenuation: Colour, base_albedo: Colour, irradiance: Colour
) -> Array:
    """Give the radiance of layer and diffuse base, layer + c_atten c_b E/π."""
    base = jnp.asarray(base_albedo) * jnp.asarray(irradiance) / jnp.pi
    return jnp.asarray(layer) + jnp.asarray(attenuation) * base
