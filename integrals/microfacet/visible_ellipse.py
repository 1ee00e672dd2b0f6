"""The directional albedo of an anisotropic GGX surface with any Fresnel reflectance.

E(o) = ∫_Ω F(o·h) f(o, i) (i·n) dω_i, with the height-correlated masking. The integration variable
is the point p of the unit sphere with h ∝ Mp, M = diag(αx, αy, 1). The p whose reflection is above
the horizon are a cone, and it is an ellipse in projection along its axis w. Let λ be the positive
root of λ = μ + X/(λ + a) + Y/(λ + b), with X = (αx ox)², a = αx²μ, and Y, b alike for y. Then
w = (αx ox/(λ + a), αy oy/(λ + b), 1), and with p = t w + d, d = (dx, dy, 0),

    i·n = λρ/|Mp|²,    1 − ρ = (1 + a/λ) dx² + (1 + b/λ) dy²,
    E = (λ/π) ∫₀^2π dβ ∫₀¹ dρ  F ν (o·Mp)/(μσ(i) + νσ(o)) / (|w| x₁ √((λ + a)(λ + b))),

where β is the angle in the ellipse and x₁ = p·w/|w|. docs/microfacet.md derives it. There is no
kink at the horizon, because the horizon is the edge ρ = 0.
"""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from integrals.reference import Estimate
from integrals.rules.interval import checked_rule, gauss_legendre
from shading.microfacet.ggx import Roughness, projected_roughness, widths
from shading.microfacet.reflection_cone import reflection_cone
from shading.types import Scalar, Vector

NODES = 96
AZIMUTHS = 1024

_LEAST_SCALE = 1e-9

Fresnel = Callable[[Float[Array, "..."]], Array]


def white(cosine: Array) -> Array:
    """Return a reflectance of one for each cosine."""
    return jnp.ones_like(cosine)


def ellipse_rule(view: Array, alpha: Array, fresnel: Fresnel, nodes: int, azimuths: int) -> Array:
    """Return E by `nodes` Gauss points in ρ and `azimuths` points in β."""
    # notation: as at the top of this file
    mu = view[2]
    cone = reflection_cone(view, alpha)
    root, drop, axis = cone.eigenvalue, (cone.drop_x, cone.drop_y), (cone.x, cone.y)
    length2 = 1 + axis[0] ** 2 + axis[1] ** 2
    shares = jnp.stack(drop) / root

    # ρ = c sinh t: near the edge ρ = 0 the integrand changes where ρ is of the order of a/λ.
    unit, unit_weights = gauss_legendre(nodes, 0.0, 1.0)
    scale = jnp.maximum(jnp.min(shares) / 2, _LEAST_SCALE)
    top = jnp.arcsinh(1 / scale)
    rho = scale * jnp.sinh(top * unit)
    rho_weights = unit_weights * top * scale * jnp.cosh(top * unit)
    semi = 1 / jnp.sqrt(1 + shares)
    turn = 2 * np.pi * np.arange(azimuths) / azimuths
    cos_beta, sin_beta = np.cos(turn), np.sin(turn)

    radius = jnp.sqrt(1 - jnp.minimum(rho, 1.0))[:, None]
    d_x, d_y = radius * cos_beta * semi[0], radius * sin_beta * semi[1]
    dot = axis[0] * d_x + axis[1] * d_y
    height2 = rho[:, None] + shares[0] * d_x**2 + shares[1] * d_y**2
    height = jnp.sqrt(height2 + dot * dot / length2)  # x₁
    t = (height * jnp.sqrt(length2) - dot) / length2
    m_x, m_y, m_z = alpha[0] * (axis[0] * t + d_x), alpha[1] * (axis[1] * t + d_y), t
    squared = m_x**2 + m_y**2 + m_z**2
    seen = view[0] * m_x + view[1] * m_y + mu * m_z  # o·Mp
    twice = 2 * seen / squared
    nu = root * rho[:, None] / squared
    i_x, i_y = twice * m_x - view[0], twice * m_y - view[1]
    sigma_light = jnp.sqrt((alpha[0] * i_x) ** 2 + (alpha[1] * i_y) ** 2 + nu * nu)
    sigma_view = projected_roughness(view, alpha)
    terms = nu * seen / ((mu * sigma_light + nu * sigma_view) * height)
    terms = terms * fresnel(jnp.minimum(seen / jnp.sqrt(squared), 1.0))
    total = 2 * jnp.pi / azimuths * (rho_weights @ jnp.sum(terms, axis=1))
    return root * total / (jnp.pi * jnp.sqrt(length2 * (root + drop[0]) * (root + drop[1])))


def anisotropic_albedo(
    view: Vector,
    alpha: Roughness,
    *,
    fresnel: Fresnel = white,
    nodes: int = NODES,
    azimuths: int = AZIMUTHS,
) -> Estimate:
    """Return the albedo for a unit vector o = `view` with o·n ≥ 0, and a bound on its error.

    `alpha` is α or (αx, αy). `fresnel` maps an array of cosines o·h to reflectances. With the
    default numbers of points the value is exact to 1e-10 for min(α) ≥ 0.05 and a ratio up to 10.
    The bound may be larger there, up to 1e-8, because it comes from ¾ of the points.
    """
    view, alpha = jnp.asarray(view, dtype=float), jnp.asarray(widths(alpha), dtype=float)

    def rule(count: int) -> Array:
        return ellipse_rule(view, alpha, fresnel, count, azimuths * count // nodes)

    return checked_rule(rule, nodes, 64 * np.finfo(float).eps)


def directional_albedo_by_ellipse(
    mu: Scalar, alpha: Scalar, *, nodes: int = NODES, azimuths: int = AZIMUTHS
) -> Estimate:
    """Return E(μ, α) of an isotropic surface and a bound on its error, by the ellipse."""
    mu = jnp.asarray(mu, dtype=float)
    # At normal incidence the sine has no slope. E depends on its square only.
    view = jnp.stack([jnp.sqrt((1 - mu) * (1 + mu) + 1e-18), jnp.zeros(()), mu])
    return anisotropic_albedo(view, alpha, nodes=nodes, azimuths=azimuths)
