"""The Fresnel split of the albedo: with Schlick's F it is F0 A + B, or F0 E + (1 − F0) B.

B(μ, α) = ∫_Ω f(o, i) (1 − o·h)⁵ (i·n) dω_i and A = E − B. Odd powers of o·h are roots of the cosine
of the azimuth, so this integral has two dimensions.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.microfacet.directional_albedo import NODES, Lights, Visibility, albedo_rule, lights
from integrals.reference import Estimate
from integrals.rules.interval import checked_rule
from shading.microfacet.ggx import correlated_visibility
from shading.types import Scalar

AZIMUTHS = 128

# Beyond this distance from the peak, in the logarithm of tan(ψ/2), the terms fall like e^(−|τ|) up
# to a factor 1 ± e^(−2·11). The last term at each end stands for all further ones.
_REACH = 11.0
# Added to s² = 1 − μ²: B is a smooth function of s², but its derivative is computed by way of s.
_SMOOTHING = 1e-18


class FresnelSplit(NamedTuple):
    """A and B: with Schlick's Fresnel reflectance the albedo is F0 A + B."""

    scale: Estimate
    offset: Estimate


def azimuth_average(mu: Scalar, alpha: Scalar, nodes: Lights, weight, azimuths: int) -> Array:
    """Return ∫₀^{2π} D(h) weight(o·h) dφ at each node, by `azimuths` points in ln tan(ψ/2).

    ψ = φ − π is zero where i is the mirror image of o. There h is nearest to n, and D has its peak,
    of width α. In τ = ln tan(ψ/2) no singularity is nearer to the real line than π/2, for any α, so
    the trapezoid rule converges like e^(−π²/step).
    """
    # notation: t = 2 + 2 o·i = 4 (o·h)², with t = lowest + spread·sin²(ψ/2). hz² = (μ + ν)²/t.
    alpha, mu, nu = jnp.asarray(alpha), jnp.asarray(mu), nodes.cosines
    sine = jnp.sqrt((1 - mu) * (1 + mu) + _SMOOTHING)
    sines = sine * jnp.sqrt(nodes.complements * (1 + nu))
    between = nodes.offsets + alpha * alpha * (mu + nu)  # ν − μ
    squared, near = (mu + nu) ** 2, 1 + mu * nu + sines
    apart = between**2 / (1 - mu * nu + sines)
    lowest, spread = 2 * squared / near, 4 * sines
    least = squared * (apart + alpha * alpha * near) / near  # of t − κ(μ + ν)²
    peak = jnp.log(least / (least + spread)) / 2
    step = (2 * _REACH - peak) / (azimuths - 1)
    tau = (peak - _REACH)[:, None] + step[:, None] * np.arange(azimuths)
    rise = spread[:, None] * jax.nn.sigmoid(2 * tau)
    t = lowest[:, None] + rise
    ratio = t / (least[:, None] + rise)
    density = alpha * alpha / jnp.pi * ratio * ratio
    ends = np.zeros(azimuths)
    ends[0] = ends[-1] = 1.0
    last = 1 / -jnp.expm1(-step)
    tails = 1 + ends * (last - 1)[:, None]
    terms = density * weight(jnp.sqrt(t) / 2) / jnp.cosh(tau) * tails
    return 2 * step * jnp.sum(terms, axis=1)


def offset_rule(mu, alpha, visibility: Visibility, nodes: int, azimuths: int) -> Array:
    """Return B by 2·`nodes` directions of light and `azimuths` azimuths."""
    at = lights(mu, alpha, nodes)
    reflected = azimuth_average(mu, alpha, at, lambda x: (1 - x) ** 5, azimuths)
    seen = jax.vmap(visibility, (None, 0, None))(mu, at.cosines, alpha)
    return jnp.sum(at.weights * seen * at.cosines * reflected)


def fresnel_split(
    mu: Scalar,
    alpha: Scalar,
    *,
    visibility: Visibility = correlated_visibility,
    nodes: int = NODES,
    azimuths: int = AZIMUTHS,
) -> FresnelSplit:
    """Return A and B with bounds on their errors, for μ ∈ [0, 1] and α ∈ (0, 1].

    The arguments are those of `directional_albedo`. The azimuth has `azimuths` points. At μ = 0 the
    derivative is that of the rule, as for E.
    """
    mu, alpha = jnp.asarray(mu, dtype=float), jnp.asarray(alpha, dtype=float)
    rounding = 16 * np.finfo(float).eps
    whole = checked_rule(lambda count: albedo_rule(mu, alpha, visibility, count), nodes, rounding)

    def rule(count: int) -> Array:
        return offset_rule(mu, alpha, visibility, count, azimuths * count // nodes)

    part = checked_rule(rule, nodes, rounding)
    return FresnelSplit(Estimate(whole.value - part.value, whole.error + part.error), part)
