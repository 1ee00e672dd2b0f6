"""The ambient model of the fuzz BRDF: averages over the hemisphere take the place of integrals.

After the talk's slides "Ambient Lighting" and "Ambient Shadowing". Light enters as its mean
radiance over the hemisphere and its irradiance (`shading.harmonics`), the material as G, Q, R (Eq.
3 to 5 of the supplement) and P_s: exact, and then in [0, 1], or fitted. Albedos are in [0, 1];
they, radiances and irradiances are scalars or colours, (3,). docs/brdf.md measures what this
costs.
"""

import jax.numpy as jnp
from jax import Array

from shading.fuzz.brdf import Colour, escape
from shading.types import Scalar


def ambient_layer(mean: Colour, albedo: Colour, scattering: Scalar, scattered: Scalar) -> Array:
    """Give the layer's radiance towards v, c_f G(d, v) (1 − P_s(v)) L̄, per steradian.

    `mean` L̄ is the light's mean radiance over the hemisphere; `albedo` c_f the fibres';
    `scattering` G(d, v) and `scattered` P_s(v). "Ambient Lighting": three averages for the average
    of three factors, and 1 − P_s(v) = ∫_Ω p(v, u) dω_u for the integral of p(u, v), as if p were
    symmetric.
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

    `cos_v` = v·n in (0, 1]; `density` d ≥ 0; `albedo` c_f of the fibres; `average_penetration` Q(d)
    and `average_scattered` R(θf, α). It multiplies the base's diffuse radiance c_b E/π and its
    specular one alike. "Ambient Shadowing"; exact for isotropic fibres in uniform light.
    """
    q = jnp.asarray(average_penetration)
    down = q + jnp.asarray(albedo) * average_scattered * (1 - q)
    return escape(cos_v, density) * down


def ambient_radiance(
    layer: Colour, attenuation: Colour, base_albedo: Colour, irradiance: Colour
) -> Array:
    """Give the radiance of layer and diffuse base, layer + c_atten c_b E/π, per steradian.

    `layer` is `ambient_layer`, `attenuation` c_atten is `ambient_attenuation`; `base_albedo` c_b is
    the diffuse base's, `irradiance` E what the light has on the surface. "Ambient Shadowing".
    """
    base = jnp.asarray(base_albedo) * jnp.asarray(irradiance) / jnp.pi
    return jnp.asarray(layer) + jnp.asarray(attenuation) * base
