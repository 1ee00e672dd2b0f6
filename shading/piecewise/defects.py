"""Differences of elementary functions that cancel for small arguments, elementwise."""

from collections.abc import Callable

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike


def sine_defect(x: ArrayLike) -> Array:
    """Return x − sin x for |x| ≤ 2π to full relative precision, in radians."""
    series = [1 / 6]
    for k in range(2, 12):
        series.append(-series[-1] / ((2 * k) * (2 * k + 1)))
    return _defect(x, series, lambda far: far - jnp.sin(far))


def chord_defect(x: ArrayLike) -> Array:
    """Return sin x − x cos x for |x| ≤ 2π to full relative precision, in radians."""
    # x³ (1/3 − x²/30 + …): the term x^(2k+1) has the factor (−1)^(k+1) 2k/(2k + 1)!
    series, factorial = [], 1.0
    for k in range(1, 12):
        factorial *= (2 * k) * (2 * k + 1)
        series.append((-1) ** (k + 1) * 2 * k / factorial)
    return _defect(x, series, lambda far: jnp.sin(far) - far * jnp.cos(far))


def tangent_defect(x: ArrayLike) -> Array:
    """Return x − atan x for x ≥ 0 to full relative precision; ∞ at ∞."""
    series = [(-1) ** (k + 1) / (2 * k + 1) for k in range(1, 26)]
    return _defect(x, series, lambda far: far - jnp.arctan(far), 0.45)


def _defect(
    x: ArrayLike, series: list[float], direct: Callable[[Array], Array], limit: float = 1.0
) -> Array:
    """Return x³ Σ seriesₖ x²ᵏ below the limit of |x|, and `direct(x)` above it."""
    x = jnp.asarray(x)
    small = jnp.abs(x) < limit
    near = jnp.where(small, x, 0.0)
    total = jnp.zeros_like(near)
    for coefficient in series[::-1]:
        total = coefficient + near * near * total
    return jnp.where(small, near**3 * total, direct(jnp.where(small, limit, x)))
