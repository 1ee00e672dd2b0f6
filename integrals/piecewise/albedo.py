"""The directional albedo E(μ) of a piecewise-linear NDF, as an integral over one variable.

With the height-correlated G2, f = D(h)/(4 (μν + H(o)ν + H(i)μ)) for unit reflectance, where μ = o·n
and ν = i·n. The half vector has (h·n)² = (μ + ν)²/t with t = a + b cos φ, a = 2 + 2μν and
b = 2 sin θo sin θi. Where D = a_k + b_k (h·n)², its integral over azimuths is elementary, since
∫ dφ/t = atan(√((a − b)/(a + b)) tan(φ/2))/(μ + ν). Only the integral over θi is left. The arcs of
the azimuth begin or end at θi = |θo ± 2θ_k| and 2θ_k − θo: between them the integrand is smooth.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.piecewise.hidden_area import hidden_area_closed
from shading.piecewise.ndf import Profile, coefficients
from shading.types import Scalar


def directional_albedo(ndf: Profile, theta_o: Scalar, *, nodes: int = 12) -> Array:
    """Return E, the part of light from θo in [0, π/2) that single reflections send upwards.

    The NDF is isotropic, normalised and linear in cos²θ. `nodes` is the number of Gauss points
    between two angles where the integrand is not smooth. Raises ValueError for an NDF that is
    linear in the angle.
    """
    if ndf.variable != "cos2":
        raise ValueError("the albedo is computed for profiles that are linear in 'cos2' only")
    theta_o = jnp.asarray(theta_o)
    twice = 2 * ndf.knots
    places = [jnp.abs(theta_o - twice), theta_o + twice, twice - theta_o, jnp.pi / 2 - ndf.knots]
    ends = jnp.sort(jnp.clip(jnp.concatenate(places), 0.0, jnp.pi / 2))
    x, weight = np.polynomial.legendre.leggauss(nodes)
    # The arcs begin like powers 3/2 of the distance: t = ½ − ¾x + ¼x³ has no slope at the ends.
    part, slope = (2 + 3 * x - x**3) / 4, (1 - x * x) * 3 / 4
    width = jnp.diff(ends)[:, None]
    theta_i = (ends[:-1, None] + width * part).ravel()
    weights = (width * slope * weight).ravel()
    mu, nu = jnp.cos(theta_o), jnp.cos(theta_i)
    area_o = hidden_area_closed(ndf, theta_o)
    area_i = hidden_areas(ndf, theta_i)
    below = mu * nu + area_o * nu + area_i * mu
    rings = azimuth_integral(ndf, theta_o, theta_i)
    values = nu * jnp.sin(theta_i) * rings / (4 * jnp.where(below > 0, below, 1.0))
    return jnp.sum(weights * values)


def hidden_areas(ndf: Profile, angles: Array) -> Array:
    """Return H (k,) at polar angles (k,)."""
    return jax.vmap(lambda theta: hidden_area_closed(ndf, theta))(angles)


def azimuth_integral(ndf: Profile, theta_o: Array, theta_i: Array) -> Array:
    """Return ∫ D(h) dφ over [0, 2π], (k,), for the half vectors of θo and of angles θi (k,)."""
    a, b = coefficients(ndf)
    mu, nu = jnp.cos(theta_o), jnp.cos(theta_i)
    # With p = tan²(φ/2): t = ((a + b) + (a − b)p)/(1 + p), and a ± b = 4cos²((θo ∓ θi)/2).
    near, far = 2 * jnp.cos((theta_o - theta_i) / 2) ** 2, 2 * jnp.cos((theta_o + theta_i) / 2) ** 2
    squared = ((mu + nu) ** 2)[:, None]
    v = jnp.cos(ndf.knots) ** 2
    # (h·n)² exceeds v from tan²(φ/2) = (2 near·v − s)/(s − 2 far·v) on, with s = (μ + ν)².
    above = jnp.maximum(2 * near[:, None] * v - squared, 0.0)
    rest = jnp.maximum(squared - 2 * far[:, None] * v, 0.0)
    none = (above == 0) & (rest == 0)
    half = jnp.arctan2(_root(above), jnp.where(none, 1.0, _root(rest)))
    turned = jnp.arctan2(
        _root(above * far[:, None]), jnp.where(none, 1.0, _root(rest * near[:, None]))
    )
    # Angles decrease from knot to knot; both halves of the circle are alike.
    arcs = -2 * jnp.diff(2 * half, axis=1)
    tilts = -2 * jnp.diff(turned, axis=1) * (mu + nu)[:, None]
    return arcs @ a + tilts @ b


def average_albedo(ndf: Profile, *, nodes: int = 48) -> Array:
    """Return E_avg = 2 ∫ E(μ) μ dμ by `nodes` Gauss points in θo, to about 1e-6."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    theta = jnp.asarray((x + 1) * np.pi / 4)
    values = jax.lax.map(lambda each: directional_albedo(ndf, each), theta)
    return jnp.sum(weight * np.pi / 4 * jnp.sin(2 * theta) * values)


def _root(x: Array) -> Array:
    """Return √x for x ≥ 0, with a derivative of zero at zero."""
    return jnp.where(x > 0, jnp.sqrt(jnp.where(x > 0, x, 1.0)), 0.0)
