"""The ambient model of the fuzz BRDF. It replaces integrals over lights by products of averages.

The source is the talk's slides "Ambient Lighting" and "Ambient Shadowing". The light is described
by its mean radiance over the hemisphere and its irradiance (`shading.harmonics`). The material is
described by G, Q, R (Eq. 3 to 5 of the supplement) and P_s. These four may be exact values, which
lie in [0, 1], or values of a fit. An albedo is in [0, 1]. Albedos, radiances and irradiances are
scalars or colours (3,). docs/brdf.md gives the error of the model.
"""

import jax.numpy as jnp
from jax import Array

from shading.fuzz.brdf import Colour, escape
from shading.types import Scalar


def ambient_layer(mean: Colour, albedo: Colour, scattering: Scalar, scattered: Scalar) -> Array:
    """Return the radiance of the layer towards v, c_f G(d, v) (1 − P_s(v)) L̄.

    The source is the slide "Ambient Lighting".

    `mean` L̄ is the mean radiance of the light over the hemisphere. `albedo` is the albedo c_f of
    the fibres. `scattering` is G(d, v) and `scattered` is P_s(v).

    The model approximates twice. It takes the product of three averages for the average of a
    product, and 1 − P_s(v) = ∫_Ω p(v, u) dω_u for ∫_Ω p(u, v) dω_u, as if p were symmetric.
    """
    return jnp.asarray(albedo) * scattering * (1 - jnp.asarray(scattered)) * jnp.asarray(mean)


def ambient_attenuation(
    cos_v: Scalar,
    density: Scalar,
    albedo: Colour,
    average_penetration: Scalar,
    average_scattered: Scalar,
) -> Array:
    """Return c_atten = P_e(v) [Q + c_f R (1 − Q)], the attenuation of the base.

    The source is the slide "Ambient Shadowing".

    `cos_v` is v·n in (0, 1], `density` is d ≥ 0 and `albedo` is the albedo c_f of the fibres.
    `average_penetration` is Q(d) and `average_scattered` is R(θf, α). The same factor multiplies
    the diffuse radiance c_b E/π of the base and its specular radiance. It is exact for isotropic
    fibres in uniform light.
    """
    q = jnp.asarray(average_penetration)
    down = q + jnp.asarray(albedo) * average_scattered * (1 - q)
    return escape(cos_v, density) * down


def ambient_radiance(
    layer: Colour, attenuation: Colour, base_albedo: Colour, irradiance: Colour
) -> Array:
    """Return the radiance of the layer and a diffuse base together, layer + c_atten c_b E/π.

    `layer` comes from `ambient_layer` and `attenuation` from `ambient_attenuation`. `base_albedo`
    is the albedo c_b of the base, and `irradiance` is the irradiance E of the surface. The source
    is the slide "Ambient Shadowing".
    """
    base = jnp.asarray(base_albedo) * jnp.asarray(irradiance) / jnp.pi
    return jnp.asarray(layer) + jnp.asarray(attenuation) * base
