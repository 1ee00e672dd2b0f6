"""Quadrature rules on standard intervals, as NumPy constants for use under `jit`."""

import functools
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.integral import Estimate


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
