"""E(μ, α), the directional albedo of an isotropic GGX surface with F = 1, by a 1-D integral.

E(o) = ∫_Ω f(o, i) (i·n) dω_i. The azimuth integral of D is elementary, whatever μ, ν and α are, so
for every G2 that depends on μ and ν only

    E = ∫₀¹ 2α² V(μ, ν) ν K dν,    K = 1 + 2κ(μ + ν)/√Q + κ²(μ + ν)A/Q^(3/2),
    Q = (κν − (1 + α²)μ)² + 4α²(1 − μ²),    A = 2α²(1 + μν) + κ(2 − μ² − ν²),    κ = 1 − α²,

with the visibility V = G2/(4μν). docs/microfacet.md derives it. All terms of K are positive.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate
from integrals.rules.interval import checked_rule, gauss_legendre
from shading.microfacet.ggx import correlated_visibility
from shading.types import Scalar

# Gauss–Legendre nodes of each of the two panels.
NODES = 64

Visibility = Callable[[Array, Array, Array], Array]

# The first panel resolves ν of the size of μ, but not below this: E feels it only like μ ln μ.
_LEAST_SCALE = 1e-12


class Lights(NamedTuple):
    """Nodes of the integral over ν = i·n, (n,) each.

    `cosines` are ν and `weights` those of dν. `offsets` are κν − (1 + α²)μ, which is zero at the
    peak, and `complements` are 1 − ν. Both are given because the differences would lose digits near
    normal incidence.
    """

    cosines: Array
    complements: Array
    weights: Array
    offsets: Array


def lights(mu: Scalar, alpha: Scalar, nodes: int) -> Lights:
    """Return 2·`nodes` nodes in ν ∈ [0, 1], placed where the integrand for μ and α needs them.

    For κμ² ≤ 4α² the map is ν = a sinh t with a = μα/σ(μ), in two halves of t. For smaller α it is
    ν = (α/√κ) sinh t below μ/2. Above, it is (1 + α²)μ/κ + w sinh t, as fine as the peak is wide.
    """
    mu, alpha = jnp.asarray(mu), jnp.asarray(alpha)
    kappa = (1 - alpha) * (1 + alpha)
    sine2 = (1 - mu) * (1 + mu)
    narrow = kappa * mu * mu > 4 * alpha * alpha
    # Where `narrow` is false these are not used, and κ may be zero.
    k = jnp.where(narrow, kappa, 1.0)
    plain = alpha * mu / jnp.sqrt(alpha * alpha + kappa * mu * mu)
    scale = jnp.where(narrow, alpha / jnp.sqrt(k), jnp.maximum(plain, _LEAST_SCALE))
    # s² + α² instead of s²: at normal incidence the peak is α² wide, because its centre is
    # beyond ν = 1 by 2α²/κ.
    width = 2 * alpha * jnp.sqrt(sine2 + alpha * alpha) / k
    top = jnp.arcsinh(1 / scale)
    middle = jnp.where(narrow, jnp.arcsinh(mu / 2 / scale), top / 2)
    unit, weights = gauss_legendre(nodes, 0.0, 1.0)

    first = middle * unit
    first_cosines = scale * jnp.sinh(first)
    first_weights = middle * weights * scale * jnp.cosh(first)

    plain = middle + (top - middle) * unit
    start = jnp.arcsinh(-(mu / 2 + 2 * alpha * alpha * mu / k) / width)
    end = jnp.arcsinh(((1 - mu) - alpha * alpha * (1 + mu)) / k / width)
    peaked = start + (end - start) * unit
    offset = width * jnp.sinh(peaked)
    plain_cosines = scale * jnp.sinh(plain)
    cosines = jnp.concatenate(
        [
            first_cosines,
            jnp.where(narrow, mu + 2 * alpha * alpha * mu / k + offset, plain_cosines),
        ]
    )
    weights = jnp.concatenate(
        [
            first_weights,
            weights
            * jnp.where(
                narrow,
                (end - start) * width * jnp.cosh(peaked),
                (top - middle) * scale * jnp.cosh(plain),
            ),
        ]
    )
    complements, offsets = 1 - cosines, kappa * cosines - (1 + alpha * alpha) * mu
    from_peak = (1 - mu) - 2 * alpha * alpha * mu / k - offset
    complements = complements.at[nodes:].set(jnp.where(narrow, from_peak, complements[nodes:]))
    offsets = offsets.at[nodes:].set(jnp.where(narrow, k * offset, offsets[nodes:]))
    # Roundings may move the last node to the other side of the zenith.
    return Lights(jnp.minimum(cosines, 1.0), jnp.maximum(complements, 0.0), weights, offsets)


def azimuth_kernel(mu: Scalar, alpha: Scalar, nodes: Lights) -> Array:
    """Return K at each node: ∫₀^{2π} D(h) dφ = 2α²K, where φ is the azimuth between o and i."""
    alpha, mu, nu = jnp.asarray(alpha), jnp.asarray(mu), nodes.cosines
    kappa, sine2 = (1 - alpha) * (1 + alpha), (1 - mu) * (1 + mu)
    root = jnp.sqrt(nodes.offsets**2 + 4 * alpha * alpha * sine2)
    linear = 2 * alpha * alpha * (1 + mu * nu) + kappa * (sine2 + nodes.complements * (1 + nu))
    return 1 + kappa * (mu + nu) * (2 + kappa * linear / (root * root)) / root


def albedo_rule(mu: Array, alpha: Array, visibility: Visibility, nodes: int) -> Array:
    """Return E by the rule with 2·`nodes` nodes."""
    at = lights(mu, alpha, nodes)
    seen = jax.vmap(visibility, (None, 0, None))(mu, at.cosines, alpha)
    terms = seen * at.cosines * azimuth_kernel(mu, alpha, at)
    return 2 * alpha * alpha * jnp.sum(at.weights * terms)


def directional_albedo(
    mu: Scalar,
    alpha: Scalar,
    *,
    visibility: Visibility = correlated_visibility,
    nodes: int = NODES,
) -> Estimate:
    """Return E(μ, α) and a bound on its error, for μ ∈ [0, 1] and α ∈ (0, 1].

    `visibility` maps scalars (μ, ν, α) to G2/(4μν). `correlated_visibility` and
    `uncorrelated_visibility` of `shading.microfacet` are two such functions. The error is below
    1e-12 for α ≥ 0.01 and μ ≥ 1e-4, with the default `nodes`.

    As μ → 0, 1 − E is αμ ln(1/μ): E has no finite slope there. The derivative at μ = 0 that JAX
    returns is finite, but it is that of the rule.
    """
    mu, alpha = jnp.asarray(mu, dtype=float), jnp.asarray(alpha, dtype=float)
    rounding = 16 * np.finfo(float).eps
    return checked_rule(lambda count: albedo_rule(mu, alpha, visibility, count), nodes, rounding)
