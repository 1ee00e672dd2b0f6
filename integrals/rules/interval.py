"""Quadrature rules on standard intervals, as NumPy constants for use under `jit`."""

import functools
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate

# Sums of terms that may have underflowed are no better than this.
_UNDERFLOW = 1e-300


@functools.cache
def gauss_legendre(nodes: int, lower: float, upper: float) -> tuple[np.ndarray, np.ndarray]:
    """Give Gauss–Legendre nodes and weights (nodes,) on [lower, upper]."""
    x, weights = np.polynomial.legendre.leggauss(nodes)
    half = (upper - lower) / 2
    return lower + half * (x + 1), half * weights


@functools.cache
def exponential_decay(step: float) -> tuple[np.ndarray, np.ndarray]:
    """Give nodes and weights for ∫₀^∞ f(s) ds, f smooth and falling off like e^(−s) or faster.

    The trapezoid rule in x after s = exp(x − e^(−x)) (Takahasi and Mori's double exponential
    transformation), cut off where the transformed weight of e^(−s) is below 1e-18.
    """
    x = np.arange(-3.8, 3.8 + step, step)
    s = np.exp(x - np.exp(-x))
    return s, step * s * (1 + np.exp(-x))


def checked_rule(rule: Callable[[int], Array], nodes: int, rounding: float | Array) -> Estimate:
    """Give the value of a rule of `nodes`, its error judged against one of ¾ the nodes.

    Even a rule that converges no faster than 1/nodes has an error of at most three times that
    difference; one that converges geometrically is better by far. `rounding` is added.
    """
    fine, coarse = rule(nodes), rule(3 * nodes // 4)
    return Estimate(fine, 3 * jnp.abs(fine - coarse) + rounding)


def checked_steps(rule: Callable[[float], Array], step: float, rounding: float) -> Estimate:
    """Give the value of a trapezoid rule of `step`, its error judged against two and four times it.

    Halving the step squares the error of a smooth integrand. Where the difference to the doubled
    step happens to vanish, the square of the difference before it stands in. `rounding` is
    relative to the value, which is positive.
    """
    fine, coarse, coarser = rule(step), rule(2 * step), rule(4 * step)
    scale = jnp.maximum(fine, _UNDERFLOW)
    relative = jnp.abs(fine - coarse) / scale + ((coarse - coarser) / scale) ** 2 + rounding
    return Estimate(fine, relative * fine + _UNDERFLOW)
