"""The GGX distribution of normals with Smith's masking, and the BRDF of single scattering.

The z axis of the frame is the normal n of the surface. `alpha` is the width of GGX: a scalar α, or
an array (2,) with the widths αx and αy along the x and y axes. It is positive, and usually ≤ 1.
Directions are unit vectors (3,) that point away from the surface. o is the view, i the light,
μ = o·n and ν = i·n.

All formulas follow from the projected roughness σ(w) = √(αx²wx² + αy²wy² + wz²). It is w·n times
1 + 2Λ(w). So the BRDF with the height-correlated G2 is D(h)/(2 (μσ(i) + νσ(o))), and no cosine is
left to divide by.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Real

from shading.phase import half_vector
from shading.types import Scalar, Vector

Roughness = Scalar | Real[ArrayLike, "2"]


def widths(alpha: Roughness) -> Array:
    """Return (αx, αy) as an array (2,), for `alpha` that is a scalar or has two elements."""
    return jnp.broadcast_to(jnp.asarray(alpha), (2,))


def projected_roughness(direction: Vector, alpha: Roughness) -> Array:
    """Return σ(w) = √(αx²wx² + αy²wy² + wz²) for a unit vector w."""
    w, (along_x, along_y) = jnp.asarray(direction), widths(alpha)
    return jnp.sqrt((along_x * w[0]) ** 2 + (along_y * w[1]) ** 2 + w[2] * w[2])


def projected_roughness_at(cosine: Scalar, alpha: Scalar) -> Array:
    """Return σ = √(α² + (1 − α²)μ²) of an isotropic surface for μ = w·n."""
    alpha, cosine = jnp.asarray(alpha), jnp.asarray(cosine)
    return jnp.sqrt(alpha * alpha + (1 - alpha) * (1 + alpha) * cosine * cosine)


def ndf(normal: Vector, alpha: Roughness) -> Array:
    """Return D(m), the area of facets with the unit normal m, per area of surface and steradian.

    D = 1/(π αx αy (mx²/αx² + my²/αy² + mz²)²) for mz > 0, and 0 for others. ∫ D(m) (m·n) dω = 1.
    """
    m, (along_x, along_y) = jnp.asarray(normal), widths(alpha)
    stretched = (m[0] / along_x) ** 2 + (m[1] / along_y) ** 2 + m[2] * m[2]
    density = 1 / (jnp.pi * along_x * along_y * stretched * stretched)
    return jnp.where(m[2] > 0, density, 0.0)


def smith_lambda(direction: Vector, alpha: Roughness) -> Array:
    """Return Smith's Λ(w) = (σ(w)/(w·n) − 1)/2 for a unit vector w with w·n > 0."""
    cosine = jnp.asarray(direction)[2]
    return (projected_roughness(direction, alpha) / cosine - 1) / 2


def masking(direction: Vector, alpha: Roughness) -> Array:
    """Return G1(w) = 1/(1 + Λ(w)) for w·n ≥ 0: the part of the facets that w sees.

    The facets are those that face w.
    """
    cosine = jnp.asarray(direction)[2]
    return 2 * cosine / (cosine + projected_roughness(direction, alpha))


def masking_shadowing(
    view: Vector, light: Vector, alpha: Roughness, *, correlated: bool = True
) -> Array:
    """Return G2, the part of the facets seen from o and from i, for μ, ν > 0.

    With `correlated` it is 1/(1 + Λ(o) + Λ(i)), for which a high facet is more likely to be seen by
    both. Otherwise it is G1(o) G1(i).
    """
    if not correlated:
        return masking(view, alpha) * masking(light, alpha)
    mu, nu = jnp.asarray(view)[2], jnp.asarray(light)[2]
    across = mu * projected_roughness(light, alpha) + nu * projected_roughness(view, alpha)
    return 2 * mu * nu / across


def correlated_visibility(cos_view: Scalar, cos_light: Scalar, alpha: Scalar) -> Array:
    """Return V = G2/(4μν) = 1/(2 (μσ(ν) + νσ(μ))) of an isotropic surface, height-correlated."""
    mu, nu = jnp.asarray(cos_view), jnp.asarray(cos_light)
    across = mu * projected_roughness_at(nu, alpha) + nu * projected_roughness_at(mu, alpha)
    return 1 / (2 * across)


def uncorrelated_visibility(cos_view: Scalar, cos_light: Scalar, alpha: Scalar) -> Array:
    """Return V = G1(μ) G1(ν)/(4μν) = 1/((μ + σ(μ)) (ν + σ(ν))) of an isotropic surface."""
    mu, nu = jnp.asarray(cos_view), jnp.asarray(cos_light)
    return 1 / ((mu + projected_roughness_at(mu, alpha)) * (nu + projected_roughness_at(nu, alpha)))


def visible_normal_density(normal: Vector, view: Vector, alpha: Roughness) -> Array:
    """Return the density D(m) max(o·m, 0) 2/(μ + σ(o)) of the normals that o sees, per steradian.

    μ may be negative: then facets are seen from below, and μ + σ(o) is computed without
    cancellation.
    """
    o, m, (along_x, along_y) = jnp.asarray(view), jnp.asarray(normal), widths(alpha)
    tilt = (along_x * o[0]) ** 2 + (along_y * o[1]) ** 2
    sigma = projected_roughness(o, alpha)
    below = tilt / jnp.where(o[2] < 0, sigma - o[2], 1.0)
    twice_area = jnp.where(o[2] < 0, below, sigma + o[2])
    return 2 * ndf(m, alpha) * jnp.maximum(o @ m, 0.0) / twice_area


def brdf(view: Vector, light: Vector, alpha: Roughness) -> Array:
    """Return the BRDF D(h) G2/(4μν) of single scattering with F = 1, per steradian.

    G2 is height-correlated: the value is D(h)/(2 (μσ(i) + νσ(o))). It is 0 unless μ > 0 and ν > 0.
    """
    o, i = jnp.asarray(view), jnp.asarray(light)
    above = (o[2] > 0) & (i[2] > 0)
    # Below the horizon o + i may be zero, and then not even the derivatives would be numbers.
    zenith = jnp.array([0.0, 0.0, 1.0])
    o, i = jnp.where(above, o, zenith), jnp.where(above, i, zenith)
    across = o[2] * projected_roughness(i, alpha) + i[2] * projected_roughness(o, alpha)
    return jnp.where(above, ndf(half_vector(i, o), alpha) / (2 * across), 0.0)
