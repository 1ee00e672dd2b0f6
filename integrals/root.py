"""The positive root of the cubic behind P_s, differentiable on the whole closed domain."""

import functools

import jax
import jax.numpy as jnp
from jax import Array


@jax.custom_jvp
def at_least(value: Array, bound: Array | float) -> Array:
    """Raise `value` to `bound` where it is lower; the derivative is always the value's own.

    For bounds that are theorems: only rounding brings a value below one, at points where the bound
    is attained, and there the bound's derivative (or `jnp.maximum`'s mean of both) is wrong.
    """
    return jnp.where(value < bound, bound, value)


@at_least.defjvp
def _own_derivative(primals, tangents):
    return at_least(*primals), tangents[0]


@functools.partial(jax.custom_jvp, nondiff_argnums=(5,))
def positive_root(
    half_a: Array, half_e: Array, m: Array, start: Array, floor: Array | float, steps: int
) -> Array:
    """Give the largest root of λ³ + Aλ² − Eλ − m, with one positive root and m ≥ 0.

    `half_a` = A/2, `half_e` = E/2. Each step replaces λ² in λ·λ² by its tangent 2sλ − s² at the
    current s and solves the quadratic that remains: unlike Newton's, it converges quadratically
    for a small root too. After the first step the iterates fall monotonically. `floor` is a known
    lower bound of A/2 + λ that keeps rounding from dividing by zero. The derivative is the
    implicit one.
    """
    root = start
    for _ in range(steps):
        half_b = at_least(half_a + root, floor)
        half_d = half_e + root * root / 2
        root = (half_d + jnp.sqrt(half_d * half_d + half_b * (m + m))) / (half_b + half_b)
    return root


@positive_root.defjvp
def _implicit(steps, primals, tangents):
    half_a, half_e = primals[:2]
    d_half_a, d_half_e, d_m = tangents[:3]
    root = positive_root(*primals, steps)
    slope = (3 * root + 4 * half_a) * root - 2 * half_e
    change = -2 * d_half_a * root * root + 2 * d_half_e * root + d_m
    return root, change / slope
