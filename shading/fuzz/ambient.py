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


def lit_fraction(scattered: Scalar, cos_vt: Scalar, alpha: Scalar) -> Array:
    """Return E_lit(v) approximately, the integral of p(u, v) over the lights u above the horizon.

    `scattered` is P_s(v) in [0, 1], `cos_vt` is v·t, and `alpha` in (0, 1] the roughness. The value
    is 1 − P_s times √(σ²/(1 − κā²)), which stands for the mean of σ(v)/σ(u), with κ = 1 − α²,
    σ² = 1 − κ(v·t)², and ā² for the mean of (u·t)². It is 1 − P_s at α = 1 and as α → 0, as the
    exact one is (docs/ambient-light.md). Both constants are fitted to exact values.
    """
    return lit_by_constants(LIT_FRACTION_CONSTANTS, 1 - jnp.asarray(scattered), cos_vt, alpha)


def ambient_layer_lit(
    mean: Colour,
    albedo: Colour,
    scattering: Scalar,
    scattered: Scalar,
    cos_vt: Scalar,
    cos_nt: Scalar,
    alpha: Scalar,
) -> Array:
    """Return the radiance of the layer towards v with both errors of `ambient_layer` corrected.

    The first four arguments are those of `ambient_layer`. `cos_vt` is v·t, `cos_nt` is n·t, and
    `alpha` in (0, 1] the roughness. All are unit vectors. The value is the same for t and −t.

    E_lit replaces 1 − P_s, as in `lit_fraction`. The factor that follows it stands for the
    correlation of the phase function with the kernel of G: the light that is scattered to v does
    not come at the mean cosine of the hemisphere. docs/ambient-light.md states the error.
    """
    total = corrected_layer(scattering, scattered, cos_vt, cos_nt, alpha, LIT_LAYER_CONSTANTS)
    return jnp.asarray(albedo) * total * mean


# The constants k₀ and k₁ in ā² = (v·t)² (1 − k₀α) + k₁ α (1 − P_s). The first are fitted to E_lit,
# the second, together with the level and slope of the correlation, to the radiance of the layer in
# uniform light. `python -m quantities.fuzz.ambient_fit` makes both fits again. 1 > k₁ and k₀ > k₁
# keep 1 − κā² above zero.
LIT_FRACTION_CONSTANTS = (1.3, 0.834)
LIT_LAYER_CONSTANTS = (1.255, 0.9438, 0.8168, 0.4011)


def corrected_layer(
    scattering: Scalar,
    scattered: Scalar,
    cos_vt: Scalar,
    cos_nt: Scalar,
    alpha: Scalar,
    constants: tuple[Scalar, ...],
) -> Array:
    """Return the layer's radiance in light of radiance one, over the albedo.

    `constants` are k₀ and k₁ of E_lit, and k₂ and k₃ of the correlation k₂ + k₃ (1 − P_s) σ σ_n.
    The other arguments are those of `ambient_layer_lit`.
    """
    # notation: up = 1 − P_s, areas = σ(v) σ(n).
    alpha = jnp.asarray(alpha)
    up, kappa = 1 - jnp.asarray(scattered), (1 - alpha) * (1 + alpha)
    view2, normal2 = (1 - kappa * jnp.asarray(each) ** 2 for each in (cos_vt, cos_nt))
    areas = jnp.sqrt(view2 * normal2)
    lit = lit_by_constants(constants[:2], up, cos_vt, alpha)
    # Views of dense layers at a grazing angle could have up to 1.02.
    return jnp.minimum(lit * (scattering * (constants[2] + constants[3] * up * areas)), 1.0)


def lit_by_constants(
    constants: tuple[Scalar, ...], up: Array, cos_vt: Scalar, alpha: Scalar
) -> Array:
    """Return `lit_fraction` with other constants (k₀, k₁). `up` is 1 − P_s."""
    alpha = jnp.asarray(alpha)
    square, kappa = jnp.asarray(cos_vt) ** 2, (1 - alpha) * (1 + alpha)
    mean_square = square * (1 - constants[0] * alpha) + constants[1] * alpha * up
    return up * jnp.sqrt((1 - kappa * square) / (1 - kappa * mean_square))


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
