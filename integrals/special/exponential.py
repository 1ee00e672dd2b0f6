"""The exponential integrals E_n(x) = ∫₁^∞ e^(−xt) t^(−n) dt for x ≥ 0 and n = 1, 2, 3.

JAX has `exp1`, `expi` and `expn` in `jax.scipy.special`, but they hang for some arguments.
"""

import math
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.types import Scalar

# Numbers of terms that give full float64 precision: the series of Ein for x ≤ 2, the series of
# γ(2, ·) for x ≤ 1, the continued fraction of E_n for x ≥ 2 (tests/integrals/test_exponential.py).
_SERIES_TERMS = 26
_GAMMA2_TERMS = 18
_FRACTION_TERMS = 60


@jax.custom_jvp
def e1(x: Scalar) -> Array:
    """Return E₁(x) = Ein(x) − γ − ln x, where γ is Euler's constant."""
    return _by_range(1, x, lambda x: ein(x) - np.euler_gamma - jnp.log(x))


def _by_range(n: int, x: Scalar, series: Callable[[Array], Array]) -> Array:
    """Return E_n(x), computed by `series` for x < 2 and by a continued fraction for x ≥ 2.

    E_n = e^(−x) / (x+n − 1·n/(x+n+2 − 2(n+1)/(x+n+4 − …))). The recursion in n, which the series
    for E₂ and E₃ use, would lose digits by cancellation for x ≥ 2.
    """
    x = jnp.asarray(x)
    small, large = jnp.where(x < 2, x, 1.0), jnp.where(x < 2, 2.0, x)

    def level(i, below):
        k = _FRACTION_TERMS - i
        return k * (k + n - 1) / (large + (2 * k + n) - below)

    below = jax.lax.fori_loop(0, _FRACTION_TERMS, level, jnp.zeros_like(large))
    return jnp.where(x < 2, series(small), jnp.exp(-large) / (large + n - below))


def ein(x: Scalar) -> Array:
    """Return Ein(x) = ∫₀^x (1 − e^(−t))/t dt = E₁(x) + ln x + γ by its series, for 0 ≤ x ≤ 2."""
    x = jnp.asarray(x)
    total = jnp.zeros_like(x)
    for k in range(_SERIES_TERMS, 0, -1):
        total = x * ((-1) ** (k + 1) / (k * math.factorial(k)) + total)
    return total


def gamma2(x: Scalar) -> Array:
    """Return γ(2, x) = ∫₀^x t e^(−t) dt = 1 − (1 + x) e^(−x) by its series, for 0 ≤ x ≤ 1."""
    x = jnp.asarray(x)
    total = jnp.zeros_like(x)
    for k in range(_GAMMA2_TERMS, 1, -1):
        total = (-1) ** k * (k - 1) / math.factorial(k) + x * total
    return x * x * total


@jax.custom_jvp
def e2(x: Scalar) -> Array:
    """Return E₂(x) = e^(−x) − x E₁(x)."""
    return _by_range(2, x, lambda x: jnp.exp(-x) - _times_e1(x))


@jax.custom_jvp
def e3(x: Scalar) -> Array:
    """Return E₃(x) = (e^(−x) − x E₂(x)) / 2."""
    return _by_range(3, x, lambda x: (jnp.exp(-x) - x * e2(x)) / 2)


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
