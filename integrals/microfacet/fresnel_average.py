"""F_avg = 2 ∫₀¹ F(x) x dx, the cosine average of a Fresnel reflectance.

That of Schlick's approximation and that of a dielectric have closed forms. docs/microfacet.md
derives the latter. That of a conductor contains elliptic integrals, and is computed by quadrature.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate
from integrals.rules.interval import checked_rule, gauss_legendre
from shading.microfacet.fresnel import conductor, dielectric
from shading.types import Scalar

_EPS = float(np.finfo(float).eps)
# Nodes of ∫₀¹ x/(1 + δx) dx for δ ≤ 1. The singularity is at x = −1 or beyond.
_NODES = 24


def schlick_average(normal_reflectance: Scalar) -> Array:
    """Return F_avg = (1 + 20 F0)/21 of Schlick's approximation."""
    return (1 + 20 * jnp.asarray(normal_reflectance)) / 21


def dielectric_average(index: Scalar) -> Estimate:
    """Return F_avg in closed form, and its error, for a relative index of refraction η > 0.

    It is not smooth at η = 1, where F_avg = 0: to first order it is (η − 1)/3 above and
    7 (1 − η)/3 below. The derivative at η = 1 is that from above.
    """
    eta = jnp.asarray(index, dtype=float)
    below = eta < 1
    n = jnp.where(below, 1 / jnp.where(below, eta, 1.0), eta)
    outside = _from_outside(n)
    value = jnp.where(below, 1 - eta * eta * (1 - outside), outside)
    return Estimate(value, 8 * _EPS * jnp.ones_like(value))


def _from_outside(n: Array) -> Array:
    """Return F_avg for n ≥ 1.

    Where n → 1, ln n cancels against rational functions. It is written as δ + δ²m, δ = n − 1, so
    that the cancellation is done in the polynomials.
    """
    delta, n2 = n - 1, n * n
    small = delta <= 1
    near, far = jnp.where(small, delta, 0.0), jnp.where(small, 1.0, delta)
    unit, weights = gauss_legendre(_NODES, 0.0, 1.0)
    by_rule = -jnp.sum(weights * unit / (1 + near * unit))
    second = jnp.where(small, by_rule, (jnp.log1p(far) - far) / (far * far))
    # In n, the leading terms grow like n⁸ and their quotient is bounded: divide by n before.
    inverse = 1 / n
    i2 = inverse * inverse
    sum2 = 1 + i2  # (n² + 1)/n²
    above = (1 + inverse) ** 2
    polynomial = 2 * inverse * (3 - 2 * i2 - 4 * i2 * inverse - i2 * i2)
    fourth = 8 * (1 + i2 * i2) * second
    rational = (polynomial + fourth) / (above * sum2**3)
    positive = delta > 0
    ratio = jnp.where(positive, delta, 1.0) / (n + 1)
    logarithm = jnp.where(positive, delta * delta * jnp.log(ratio), 0.0)
    logarithm = logarithm * above / (n2 * sum2**3)
    slope = delta * (3 * n + 1) / (6 * (n + 1) ** 2)
    return 0.5 + slope + logarithm + rational


def dielectric_average_by_quadrature(index: Scalar, *, nodes: int = 64) -> Estimate:
    """Return F_avg of a dielectric and a bound on its error, for a relative index η > 0.

    For η < 1 the angles of total reflection count 1 − η², and the others are integrated over the
    cosine of the refracted light, times η, so that there is no root.
    """
    eta = jnp.asarray(index, dtype=float)
    gap = jnp.abs((eta - 1) * (eta + 1))
    below = eta < 1
    width = jnp.maximum(jnp.sqrt(gap + 1e-300), 1e-8)
    end = jnp.where(below, eta, 1.0)

    def rule(count: int) -> Array:
        unit, weights = gauss_legendre(count, 0.0, 1.0)
        top = jnp.arcsinh(end / width)
        y = width * jnp.sinh(top * unit)
        cosine = jnp.where(below, jnp.sqrt(y * y + gap), y)
        slope = top * width * jnp.cosh(top * unit)
        values = jax.vmap(dielectric, (0, None))(jnp.minimum(cosine, 1.0), eta)
        return jnp.where(below, gap, 0.0) + 2 * jnp.sum(weights * slope * y * values)

    return checked_rule(rule, nodes, 16 * _EPS)


def conductor_average(index: Scalar, extinction: Scalar, *, nodes: int = 100) -> Estimate:
    """Return F_avg of a conductor and a bound on its error, for η + ik with η > 0 and k ≥ 0.

    The rule has `nodes` nodes in u with x = u³, since F rises steeply towards grazing light.
    """
    eta, k = jnp.asarray(index, dtype=float), jnp.asarray(extinction, dtype=float)

    def rule(count: int) -> Array:
        unit, weights = gauss_legendre(count, 0.0, 1.0)
        values = jax.vmap(conductor, (0, None, None))(unit**3, eta, k)
        return 6 * jnp.sum(weights * unit**5 * values)

    return checked_rule(rule, nodes, 16 * _EPS)
