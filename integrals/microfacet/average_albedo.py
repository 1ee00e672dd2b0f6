"""E_avg(α) = 2 ∫₀¹ E(μ, α) μ dμ, the cosine average of the directional albedo.

With μ = (α/√κ) sinh a and ν = (α/√κ) sinh b, the integrand of E is simple in p = (a + b)/2 and
w = sinh((a − b)/2), and the integral over w is elementary. docs/microfacet.md derives it. In the
same words, with S = sinh²p, A = 1 − α²S, B = 1 + κS, sinh a₁ = √κ/α and q = min(p, a₁ − p):

    E_avg = α⁴κ^(−3/2) ∫₀^a₁ dp/sinh 2p { 2q (cosh² 2p − ½) − ¼ sinh 4q
            + (2α/√κ) sinh p ∫_{|w| < sinh q} (κ/α³) (S − w²) (1 + S + w²)
                  [2α²(A + Bw²) + A + α²(1 + w²)] (A + Bw²)^(−3/2) dw }.

The code divides p, q, w and sinh p by √κ, so that α = 1 is no exception.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.microfacet.directional_albedo import albedo_rule
from integrals.reference import Estimate
from integrals.rules.interval import checked_rule, gauss_legendre
from shading.microfacet.ggx import correlated_visibility
from shading.types import Scalar

NODES = 48

_SERIES_LIMIT = 0.5
_SERIES_TERMS = 12
# Nodes for ∫ x^(2k) (1 + z x²)^(−3/2) dx with z ≤ 1. Its singularities are at x = ±i or beyond.
_MOMENT_NODES = 24


def _series(z: Array, coefficients: np.ndarray) -> Array:
    total = jnp.zeros_like(z)
    for coefficient in coefficients[::-1]:
        total = coefficient + z * total
    return total


def _factorials(first: int, count: int) -> np.ndarray:
    """Return 1/first!, 1/(first + 2)!, …, `count` numbers."""
    return np.array([1 / float(np.prod(np.arange(1.0, first + 2 * n + 1))) for n in range(count)])


def _by_series(z: Array, coefficients: np.ndarray, function) -> Array:
    """Return Σ coefficients zⁿ for z below the limit, and function(√z) above."""
    small = z < _SERIES_LIMIT
    root = jnp.sqrt(jnp.where(small, 1.0, z))
    return jnp.where(small, _series(jnp.where(small, z, 0.0), coefficients), function(root))


def sinh_ratio(z: Array) -> Array:
    """Return sinh(√z)/√z for z ≥ 0, which is smooth at z = 0."""
    return _by_series(z, _factorials(1, _SERIES_TERMS), lambda x: jnp.sinh(x) / x)


def sinh_excess(z: Array) -> Array:
    """Return (sinh(√z) − √z)/√z³ for z ≥ 0, which is smooth at z = 0."""
    return _by_series(z, _factorials(3, _SERIES_TERMS), lambda x: (jnp.sinh(x) - x) / x**3)


def asinh_ratio(z: Array) -> Array:
    """Return arsinh(√z)/√z for z ≥ 0, which is smooth at z = 0: ∫₀¹ (1 + z x²)^(−½) dx."""
    unit, weights = gauss_legendre(_MOMENT_NODES, 0.0, 1.0)
    small = z < _SERIES_LIMIT
    inner = jnp.where(small, z, 0.0)
    near = jnp.sum(weights / jnp.sqrt(1 + inner[..., None] * unit * unit), axis=-1)
    root = jnp.sqrt(jnp.where(small, 1.0, z))
    return jnp.where(small, near, jnp.arcsinh(root) / root)


def moments(z: Array) -> tuple[Array, ...]:
    """Return ∫₀¹ x^(2k) (1 + z x²)^(−3/2) dx for k = 0, 1, 2, 3 and z ≥ 0.

    They are elementary. Their formulas lose digits for small z, where a Gauss rule is exact.
    """
    unit, weights = gauss_legendre(_MOMENT_NODES, 0.0, 1.0)
    small = z < 1
    inner, outer = jnp.where(small, z, 0.0), jnp.where(small, 1.0, z)
    weight = weights * (1 + inner[..., None] * unit * unit) ** -1.5
    root = jnp.sqrt(1 + outer)
    plain = jnp.arcsinh(jnp.sqrt(outer)) / jnp.sqrt(outer)  # ∫ (1 + z x²)^(−½)
    second = (root - plain) / (2 * outer)
    fourth = (root - 3 * second) / (4 * outer)
    zero = 1 / root
    one = (plain - zero) / outer
    two = (second - one) / outer
    three = (fourth - two) / outer
    return tuple(
        jnp.where(small, jnp.sum(weight * unit ** (2 * k), axis=-1), far)
        for k, far in enumerate((zero, one, two, three))
    )


def average_rule(alpha: Array, nodes: int) -> Array:
    """Return E_avg by 2·`nodes` nodes in p, half of them on either side of the kink at a₁/2."""
    # notation: as above, where u, v, y, S stand for p/√κ, q/√κ, w_max/√κ, sinh²p/κ.
    alpha2, kappa = alpha * alpha, (1 - alpha) * (1 + alpha)
    end = asinh_ratio(kappa / alpha2) / alpha  # a₁/√κ
    unit, weights = gauss_legendre(nodes, 0.0, 1.0)
    half = end / 2
    # Near the upper end the integrand varies within a distance of the order of α².
    stretch = jnp.arcsinh(half / alpha2)
    near = alpha2 * jnp.sinh(stretch * unit)
    u = jnp.concatenate([half * unit, end - near])
    v = jnp.concatenate([half * unit, near])
    weights = jnp.concatenate(
        [half * weights, alpha2 * stretch * weights * jnp.cosh(stretch * unit)]
    )
    sine = u * sinh_ratio(kappa * u * u)  # sinh p/√κ
    cosine = jnp.sqrt(1 + kappa * sine * sine)
    s = sine * sine
    double = 2 * sine * cosine  # sinh 2p/√κ
    y = v * sinh_ratio(kappa * v * v)
    # 2q(cosh² 2p − ½) − ¼ sinh 4q = 2q sinh² 2p − ¼(sinh 4q − 4q), over κ^(3/2)
    plain = 2 * v * double * double - 16 * v**3 * sinh_excess(16 * kappa * v * v)

    a, b = 1 - alpha2 * kappa * s, 1 + kappa * kappa * s
    z = b * kappa * y * y / a
    m0, m1, m2, m3 = moments(z)
    # (S − w²)(1 + S + w²) and the bracket as polynomials in w², with w² = κ y² x²
    w2 = kappa * y * y
    f0, f1, f2 = s * (1 + kappa * s), -y * y, -y * y * w2
    g0, g1 = (2 * alpha2 + 1) * a + alpha2, alpha2 * (2 * b + 1) * w2
    inner = f0 * g0 * m0 + (f0 * g1 + f1 * g0) * m1 + (f1 * g1 + f2 * g0) * m2 + f2 * g1 * m3
    # The factor κ² of (κ/α³)(S − w²) against √κ of 2α sinh p/√κ, and κ of dw and the prefactor.
    peaked = 4 * kappa * sine * y * inner / (alpha2 * a * jnp.sqrt(a))
    total = (plain + peaked) / double
    return alpha2 * alpha2 * jnp.sum(weights * total)


def average_albedo(alpha: Scalar, *, nodes: int = NODES) -> Estimate:
    """Return E_avg(α) and a bound on its error, for α ∈ (0, 1], by the 1-D integral.

    It is that of the height-correlated masking.
    """
    alpha = jnp.asarray(alpha, dtype=float)
    return checked_rule(lambda count: average_rule(alpha, count), nodes, 16 * np.finfo(float).eps)


def average_of_directional(alpha: Scalar, *, nodes: int = 48) -> Estimate:
    """Return E_avg(α) and a bound on its error by averaging E: an independent, slower method.

    The nodes are μ = α sinh t², in which E is smooth, although it is μ ln μ at grazing views.
    """
    alpha = jnp.asarray(alpha, dtype=float)

    def rule(count: int) -> Array:
        unit, weights = gauss_legendre(count, 0.0, 1.0)
        top = jnp.sqrt(jnp.arcsinh(1 / alpha))
        t = top * unit
        mu = alpha * jnp.sinh(t * t)
        slope = alpha * jnp.cosh(t * t) * 2 * t * top
        each = jax.vmap(lambda x: albedo_rule(x, alpha, correlated_visibility, count))(mu)
        return 2 * jnp.sum(weights * slope * mu * each)

    return checked_rule(rule, nodes, 16 * np.finfo(float).eps)
