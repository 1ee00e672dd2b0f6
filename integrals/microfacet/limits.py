"""Limits of E and closed forms on the edges of its domain. docs/microfacet.md proves them.

As α → 0 with x = μ/α fixed, E tends to a function e(x) that is not 1: `smooth_limit`. It has a
minimum of 0.891 near x = 1.106. So 11 % of the energy is missing at μ ≈ 1.1 α, however smooth the
surface is.
"""

import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate
from integrals.rules.interval import checked_rule, gauss_legendre
from shading.types import Scalar

_LEAST_SCALE = 1e-12


def smooth_limit(ratio: Scalar, *, nodes: int = 64) -> Estimate:
    """Return e(x) = lim E(αx, α) for α → 0 and x ≥ 0, and a bound on its error.

    e(x) = ∫₀^∞ 2y (x + y)/[(x√(1 + y²) + y√(1 + x²)) ((y − x)² + 4)^(3/2)] dy, where y = ν/α. It
    is split at x/2. At x = 0, where e = 1, the slope is −0.21106.
    """
    x = jnp.asarray(ratio, dtype=float)

    def rule(count: int) -> Array:
        unit, weights = gauss_legendre(count, 0.0, 1.0)
        scale = jnp.maximum(x / jnp.sqrt(1 + x * x), _LEAST_SCALE)
        edge = jnp.maximum(x, _LEAST_SCALE) / 2
        middle = jnp.arcsinh(edge / scale)
        low = scale * jnp.sinh(middle * unit)
        low_weights = weights * middle * scale * jnp.cosh(middle * unit)
        # y = x + 2 tan θ: the peak of the second factor is then as wide as the interval of θ.
        angle = jnp.arctan((edge - x) / 2)
        theta = angle + (np.pi / 2 - angle) * unit
        high = x + 2 * jnp.tan(theta)
        high_weights = weights * (np.pi / 2 - angle) * 2 / jnp.cos(theta) ** 2
        y, w = jnp.concatenate([low, high]), jnp.concatenate([low_weights, high_weights])
        across = x * jnp.sqrt(1 + y * y) + y * jnp.sqrt(1 + x * x)
        return jnp.sum(w * 2 * y * (x + y) / (across * ((y - x) ** 2 + 4) ** 1.5))

    return checked_rule(rule, nodes, 16 * np.finfo(float).eps)


def fully_rough_albedo(mu: Scalar) -> Array:
    """Return E(μ, 1) = 1 − μ ln(1 + 1/μ) for μ in (0, 1]."""
    mu = jnp.asarray(mu, dtype=float)
    return 1 - mu * jnp.log1p(1 / mu)


def fully_rough_uncorrelated_albedo(mu: Scalar) -> Array:
    """Return E(μ, 1) = 2 (1 − ln 2)/(1 + μ) of the uncorrelated masking."""
    return 2 * (1 - np.log(2)) / (1 + jnp.asarray(mu))


def normal_albedo(alpha: Scalar) -> Array:
    """Return E(1, α) in closed form for α in [0.1, 1).

    The formula divides by α⁴, so it loses digits for smaller α. It is 1 − ln 2 at α = 1.
    """
    # notation: p = α², κ = 1 − α², q = √(κ(1 + 3p)), as in docs/microfacet.md
    a = jnp.asarray(alpha)
    p = a * a
    kappa = (1 - a) * (1 + a)
    q = jnp.sqrt(kappa * (1 + 3 * p))
    inside = 2 * a * p * (a * kappa + q) / ((1 + p) * (kappa * (1 + 2 * p) + q))
    total = 2 * a * p - (1 + p * p) * jnp.log((1 + a) / a) - jnp.log(p)
    total = total + (1 - p * p) * jnp.log((1 + p) / p)
    slope = jnp.sqrt(kappa) * (1 + 2 * p - p * p) / jnp.sqrt(1 + 3 * p)
    return (total + slope * jnp.log(inside)) / (2 * p * p)
