"""Exponential integrals E_n(x) = ∫₁^∞ e^(−xt) t^(−n) dt for x ≥ 0, n = 1, 2, 3.

Own code because `jax.scipy.special.exp1`, `expi` and `expn` do not return for some arguments.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.types import Scalar

# Terms that reach float64 for x ≤ 2 and x ≥ 2 respectively (tests/test_exponential.py).
_SERIES_TERMS = 26
_FRACTION_TERMS = 60


@jax.custom_jvp
def e1(x: Scalar) -> Array:
    """Give E₁(x): by its series up to x = 2, beyond by its continued fraction."""
    x = jnp.asarray(x)
    small, large = jnp.where(x < 2, x, 1.0), jnp.where(x < 2, 2.0, x)
    series = ein(small) - np.euler_gamma - jnp.log(small)
    return jnp.where(x < 2, series, jnp.exp(-large) * _fraction(large))


def _fraction(x: Array) -> Array:
    """Give e^x E₁(x) = 1/(x+1 − 1²/(x+3 − 2²/(x+5 − …))) for x ≥ 2."""

    def level(i, below):
        k = _FRACTION_TERMS - i
        return k * k / (x + (2 * k + 1) - below)

    return 1 / (x + 1 - jax.lax.fori_loop(0, _FRACTION_TERMS, level, jnp.zeros_like(x)))


def ein(x: Scalar) -> Array:
    """Give Ein(x) = ∫₀^x (1 − e^(−t))/t dt = E₁(x) + ln x + γ by its series, for 0 ≤ x ≤ 2."""
    x = jnp.asarray(x)
    total = jnp.zeros_like(x)
    for k in range(_SERIES_TERMS, 0, -1):
        total = x * ((-1) ** (k + 1) / (k * math.factorial(k)) + total)
    return total


@jax.custom_jvp
def e2(x: Scalar) -> Array:
    """Give E₂(x) = e^(−x) − x E₁(x)."""
    x = jnp.asarray(x)
    return jnp.exp(-x) - _times_e1(x)


@jax.custom_jvp
def e3(x: Scalar) -> Array:
    """Give E₃(x) = (e^(−x) − x E₂(x)) / 2."""
    x = jnp.asarray(x)
    return (jnp.exp(-x) - x * e2(x)) / 2


def one_minus_e2(x: Scalar) -> Array:
    """Give 1 − E₂(x) to full relative precision for small x."""
    x = jnp.asarray(x)
    return -jnp.expm1(-x) + _times_e1(x)


def _times_e1(x: Array) -> Array:
    return jnp.where(x > 0, x * e1(jnp.where(x > 0, x, 1.0)), 0.0)


@e1.defjvp
def _e1_derivative(primals, tangents):
    (x,), (dx,) = primals, tangents
    return e1(x), -jnp.exp(-x) / x * dx


@e2.defjvp
def _e2_derivative(primals, tangents):
    (x,), (dx,) = primals, tangents
    return e2(x), -e1(x) * dx


@e3.defjvp
def _e3_derivative(primals, tangents):
    (x,), (dx,) = primals, tangents
    return e3(x), -e2(x) * dx
