"""Analytic isotropic NDFs by their distributions of slopes, from which profiles are made.

The Student-t NDF (STD) of Ribardière et al. (2017) has Beckmann's and GGX's as special cases: GGX
has the exponent γ = 2, and Beckmann's is the limit γ → ∞. `width` is α, the roughness squared. The
functions work elementwise.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike


def student_t(theta: ArrayLike, width: ArrayLike, exponent: ArrayLike) -> Array:
    """Return D(θ) of the Student-t NDF, per steradian, for the exponent γ > 1 and θ in [0, π/2].

    D = ((γ − 1)α²)^γ / (π α² (…)^γ) with … = (γ − 1)α² cos²θ + sin²θ, times cos^(2γ−4) θ.
    """
    cosine, sine = jnp.cos(theta), jnp.sin(theta)
    spread = (exponent - 1) * jnp.asarray(width) ** 2
    ratio = spread / (spread * cosine**2 + sine**2)
    # Each of the two powers may overflow. For γ < 2 the NDF is infinite at π/2.
    power = exponent * jnp.log(ratio) + (2 * exponent - 4) * jnp.log(jnp.maximum(cosine, 1e-30))
    return jnp.exp(power) / (jnp.pi * jnp.asarray(width) ** 2)


def beckmann(theta: ArrayLike, width: ArrayLike) -> Array:
    """Return D(θ) of Beckmann's NDF, per steradian, for θ in [0, π/2]. It is 0 at π/2."""
    cosine, sine = jnp.cos(theta), jnp.sin(theta)
    lit = cosine > 1e-8
    safe = jnp.where(lit, cosine, 1.0)
    tail = jnp.exp(-((sine / (safe * width)) ** 2)) / (jnp.pi * jnp.asarray(width) ** 2 * safe**4)
    return jnp.where(lit, tail, 0.0)
