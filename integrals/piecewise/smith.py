"""Smith's masking of microfacets: Λ, G1 and the height-correlated G2 of any profile of normals.

Let o be a direction with the polar angle θo, and H = ∫ max(−o·m, 0) D(m) dω, the projected area of
the microfacets that face away from it. If D does not change under m → (−m_x, −m_y, m_z), then
∫ (o·m) D dω = cos θo, and so Λ = H/cos θo. Only normals with θ > E = π/2 − θo can face away, so
nothing cancels: neither the paper's I₁ and I₂ nor its tables of partial sums are needed. Because
D ≥ 0, H ≥ 0, and 0 < G1 = cos θo/(cos θo + H) ≤ 1 for every θo < π/2.

With cos θ = sin θo cos A, the azimuths that face away are those within C of o's opposite one, where
tan C = tan A/cos θo, and

    H = 2 sin²θo ∫ D (sin A − cos θo cos A · C) sin A dA    over A in [0, π/2].

A blend of two profiles adds ±cos 2φo · (2/3) ∫ D sin²θo sin⁴A/sin²θ dA, for D_x and for D_y.
"""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.piecewise.blend import Blend, weights
from shading.piecewise.defects import tangent_defect
from shading.piecewise.hidden_area import beyond_edge, hidden_area_closed
from shading.piecewise.ndf import Profile, density
from shading.types import Scalar

# At grazing directions the integrand varies over A ≈ cos θo: panels end at these multiples of it.
_LAYERS = np.array([0.25, 1.0, 3.0, 9.0, 27.0])


def hidden_area(ndf: Profile | Blend, theta_o: Scalar, phi_o: Scalar = 0.0) -> Array:
    """Return H = ∫ max(−o·m, 0) D dω for o at θo in [0, π/2] and azimuth φo, in radians.

    The closed form is used for profiles that are linear in cos²θ, quadrature for the others, and
    for blends.
    """
    if isinstance(ndf, Profile):
        if ndf.variable == "cos2":
            return hidden_area_closed(ndf, theta_o)
        return hidden_area_quadrature(ndf, theta_o)
    x, y = weights(ndf)
    turn = jnp.cos(2 * jnp.asarray(phi_o))
    along = hidden_area_quadrature(ndf.x, theta_o, turn)
    return x * along + y * hidden_area_quadrature(ndf.y, theta_o, -turn)


def smith_lambda(ndf: Profile | Blend, theta_o: Scalar, phi_o: Scalar = 0.0) -> Array:
    """Return Λ(o) = H/cos θo for θo in [0, π/2); it is infinite at π/2 (Eq. 34)."""
    return hidden_area(ndf, theta_o, phi_o) / jnp.cos(theta_o)


def smith_g1(ndf: Profile | Blend, theta_o: Scalar, phi_o: Scalar = 0.0) -> Array:
    """Return G1 = 1/(1 + Λ), the visible part of the microfacets, in [0, 1] (Eq. 29 and 32)."""
    cosine = jnp.cos(theta_o)
    return cosine / (cosine + hidden_area(ndf, theta_o, phi_o))


def smith_g2(
    ndf: Profile | Blend,
    theta_i: Scalar,
    theta_o: Scalar,
    phi_i: Scalar = 0.0,
    phi_o: Scalar = 0.0,
) -> Array:
    """Return the height-correlated G2 = 1/(1 + Λ(i) + Λ(o)) of two directions (Eq. 33)."""
    mu_i, mu_o = jnp.cos(theta_i), jnp.cos(theta_o)
    area_i, area_o = hidden_area(ndf, theta_i, phi_i), hidden_area(ndf, theta_o, phi_o)
    both = mu_i * mu_o
    below = both + mu_o * area_i + mu_i * area_o
    return jnp.where(below > 0, both / jnp.where(below > 0, below, 1.0), 0.0)


def hidden_area_quadrature(
    ndf: Profile, theta_o: Scalar, turn: Scalar = 0.0, *, nodes: int = 24
) -> Array:
    """Return H of a profile by `nodes` Gauss points between knots, to about 1e-14 relative.

    With `turn` = cos 2φo it is H of the part 2cos²φ D(θ) of a blend, with −cos 2φo of 2sin²φ D(θ).
    """
    theta, weights = hidden_rule(theta_o, ndf.knots, turn, nodes=nodes)
    return jnp.sum(weights * density(ndf, theta))


def hidden_area_of(
    of: Callable[[Array], Array], theta_o: Scalar, breaks: Array | np.ndarray, *, nodes: int = 24
) -> Array:
    """Return H of any isotropic NDF D(θ) = `of(theta)`, per steradian, by quadrature.

    `of` maps angles (k,) to values (k,). `breaks` (n,) are angles between which it is smooth; they
    increase from 0 to π/2 and should be close to each other where it is steep. `nodes` is the
    number of Gauss points between two of them.
    """
    theta, weights = hidden_rule(theta_o, jnp.asarray(breaks), nodes=nodes)
    return jnp.sum(weights * of(theta))


def hidden_rule(
    theta_o: Scalar, breaks: Array | np.ndarray, turn: Scalar = 0.0, *, nodes: int = 24
) -> tuple[Array, Array]:
    """Return polar angles and weights, (m,) each: H is the sum of the weights times D there.

    The rule is exact for D that is smooth between the `breaks` (n,), which increase from 0 to π/2,
    and has `nodes` Gauss points between two of them. `turn` is ±cos 2φo for a part of a blend.
    """
    theta_o = jnp.asarray(theta_o)
    sine, cosine = jnp.sin(theta_o), jnp.cos(theta_o)
    u, r = beyond_edge(breaks, theta_o)
    openings = jnp.arctan2(r, jnp.where((u == 0) & (r == 0), 1.0, u))
    edges = jnp.sort(jnp.concatenate([openings, jnp.arctan(_LAYERS * cosine)]))
    x, weight = np.polynomial.legendre.leggauss(nodes)
    half = jnp.diff(edges)[:, None] / 2
    at = (edges[:-1, None] + half * (x + 1)).ravel()
    tangent, rim = jnp.tan(at), jnp.sin(at)
    # cos θ = sin θo cos A. The angle itself is that of the sine, which keeps digits near θ = 0.
    across = jnp.hypot(cosine, sine * rim)
    theta = jnp.arctan2(across, sine * jnp.cos(at))
    away = hidden_kernel(tangent, rim, cosine)
    lean = turn * sine**2 * rim**3 / (3 * across**2)
    return theta, 2 * (half * weight).ravel() * rim * (sine**2 * away + lean)


def hidden_kernel(tangent: Array, rim: Array, cosine: Array) -> Array:
    """Return sin A − cos θo cos A · C from tan A, sin A and cos θo, without cancellation."""
    flat = cosine <= 0
    ratio = tangent / jnp.where(flat, 1.0, cosine)
    # cos θo cos A (x − atan x) with x = tan A/cos θo
    level = cosine * rim / jnp.where(tangent == 0, 1.0, tangent)
    return jnp.where(flat, rim, level * tangent_defect(ratio))
