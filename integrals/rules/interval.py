"""Quadrature rules for intervals, and estimates of their error."""

import functools
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate

# The absolute error of a sum whose terms may have underflowed to zero.
_UNDERFLOW = 1e-300


@functools.cache
def gauss_legendre(nodes: int, lower: float, upper: float) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss–Legendre nodes and weights, (nodes,) each, on [lower, upper]."""
    x, weights = np.polynomial.legendre.leggauss(nodes)
    half = (upper - lower) / 2
    return lower + half * (x + 1), half * weights


def composite_gauss(ends: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss–Legendre nodes and weights, (segments · nodes,) each, between the `ends`."""
    x, weights = gauss_legendre(nodes, -1.0, 1.0)
    half = np.diff(ends)[:, None] / 2
    return (ends[:-1, None] + half * (x + 1)).ravel(), (half * weights).ravel()


@functools.cache
def exponential_decay(step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights for ∫₀^∞ f(s) ds, where f is smooth and decays at least like e^(−s).

    This is the double exponential rule of Takahasi and Mori: the trapezoid rule of the given `step`
    in x after the substitution s = exp(x − e^(−x)). It ends near |x| = 3.8, because the
    terms beyond are below 1e-18 for f = e^(−s).
    """
    x = np.arange(-3.8, 3.8 + step, step)
    s = np.exp(x - np.exp(-x))
    return s, step * s * (1 + np.exp(-x))


def checked_rule(rule: Callable[[int], Array], nodes: int, rounding: float | Array) -> Estimate:
    """Return the value of a rule with `nodes` nodes, and a bound on its error.

    `rule` maps a number of nodes to a value. The error is three times the difference to the rule
    with ¾ of the nodes, plus `rounding`. This holds even if the rule converges only like 1/nodes. A
    rule that converges geometrically is much better.
    """
    fine, coarse = rule(nodes), rule(3 * nodes // 4)
    return Estimate(fine, 3 * jnp.abs(fine - coarse) + rounding)


def checked_steps(rule: Callable[[float], Array], step: float, rounding: float) -> Estimate:
    """Return the value of a trapezoid rule with `step`, and a bound on its error.

    `rule` maps a step to a value, which must not be negative. The relative error is a sum of three
    terms: the difference to the rule with twice the step, the square of the difference between the
    rules with twice and with four times the step, and `rounding`. For a smooth integrand, halving
    the step squares the relative error, so the squared term has the right size. It protects against
    a first difference that is small by chance.
    """
    fine, coarse, coarser = rule(step), rule(2 * step), rule(4 * step)
    scale = jnp.maximum(fine, _UNDERFLOW)
    relative = jnp.abs(fine - coarse) / scale + ((coarse - coarser) / scale) ** 2 + rounding
    return Estimate(fine, relative * fine + _UNDERFLOW)
