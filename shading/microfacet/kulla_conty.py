"""Energy that single scattering loses on a rough surface, and how a renderer returns it.

C. Kulla and A. Conty (Revisiting Physically Based Shading at Imageworks, 2017) return the light
that is scattered more than once as f_ms = F_ms (1 − E(i))(1 − E(o))/(π (1 − E_avg)). E is the
directional albedo of single scattering with F = 1, and E_avg its cosine average. F_ms depends on
the cosine average F_avg of the Fresnel reflectance. With F = 1 nothing is lost: f_ms returns
1 − E(o), if and only if E_avg is the average of the same E.

All functions take albedos and averages in [0, 1] as scalars. They are the same for exact values
and for tables.
"""

import jax.numpy as jnp
from jax import Array

from shading.types import Scalar


def multiple_scattering(
    albedo_view: Scalar, albedo_light: Scalar, average_albedo: Scalar, color: Scalar = 1.0
) -> Array:
    """Return f_ms, per steradian, for E(o), E(i), E_avg < 1 and F_ms, which is `color`.

    It is the same if view and light are exchanged.
    """
    missing = (1 - jnp.asarray(albedo_view)) * (1 - jnp.asarray(albedo_light))
    return color * missing / (jnp.pi * (1 - jnp.asarray(average_albedo)))


def color_by_hill(average_fresnel: Scalar, average_albedo: Scalar) -> Array:
    """Return F_ms = F² E_avg/(1 − F (1 − E_avg)), with F = F_avg.

    S. Hill, A Multi-Faceted Exploration (Part 2), 2018. It is the sum over the number of
    reflections, from two on, if each reflects F_avg, and E_avg of the light leaves after each.
    """
    f, e = jnp.asarray(average_fresnel), jnp.asarray(average_albedo)
    return f * f * e / (1 - f * (1 - e))


def color_by_kulla_conty(average_fresnel: Scalar, average_albedo: Scalar) -> Array:
    """Return F_ms = F E_avg/(1 − F (1 − E_avg)), with F = F_avg, as Kulla and Conty 2017 have it.

    It has one factor F less than Hill's, so it is too bright for dark metals.
    """
    f, e = jnp.asarray(average_fresnel), jnp.asarray(average_albedo)
    return f * e / (1 - f * (1 - e))


def color_of_walk(average_fresnel: Scalar, average_albedo: Scalar) -> Array:
    """Return F_ms = F² (1 − q)/(1 − F q) with q = ⅔ (1 − E_avg) and F = F_avg.

    It is Hill's series, but after the first reflections less light stays on the surface than
    1 − E_avg. The factor ⅔ is a least-squares fit (0.66) to a random walk on the microsurface. The
    errors against the walk are half of those of Hill's colour (docs/microfacet.md).
    """
    f, stays = jnp.asarray(average_fresnel), 2 * (1 - jnp.asarray(average_albedo)) / 3
    return f * f * (1 - stays) / (1 - f * stays)


def turquin_scale(normal_reflectance: Scalar, albedo_view: Scalar) -> Array:
    """Return 1 + F0 (1 − E(o))/E(o), by which single scattering is multiplied, for E(o) > 0.

    E. Turquin, Practical Multiple Scattering Compensation for Microfacet Models, 2019. It depends
    on the view and not on the light, so it is not reciprocal.
    """
    e = jnp.asarray(albedo_view)
    return 1 + jnp.asarray(normal_reflectance) * (1 - e) / e
