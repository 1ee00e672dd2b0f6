"""The positive root of the cubic behind P_s, differentiable on the whole closed domain."""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import Array

Step = Callable[[Array, Array, Array, Array], Array]


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


@jax.custom_jvp
def magnitude(value: Array) -> Array:
    """Give |value| of what only rounding makes negative; the derivative is the value's own."""
    return jnp.abs(value)


magnitude.defjvp(lambda primals, tangents: (magnitude(*primals), tangents[0]))


def newton_step(root: Array, a: Array, e: Array, m: Array) -> Array:
    """Follow the tangent of the cubic: of a relative error ε above the root at most 2ε² is left.

    λ − f/f′ is written as one quotient, whose numerator is a sum of positive terms.
    """
    product = (root + a) * root
    rising = root * root + product
    return (rising * root + m) / (rising + (product - e))


def tangent_step(root: Array, a: Array, e: Array, m: Array) -> Array:
    """Replace λ² in λ·λ² by its tangent 2sλ − s² at s, and solve the quadratic that remains.

    Converges quadratically for starts that are far too large, too.
    """
    b, d = root + root + a, e + root * root
    return (d + jnp.sqrt(d * d + 4 * b * m)) / (b + b)


@functools.partial(jax.custom_jvp, nondiff_argnums=(4, 5))
def positive_root(a: Array, e: Array, m: Array, start: Array, step: Step, steps: int) -> Array:
    """Give the largest root of λ³ + Aλ² − Eλ − m, with one positive root and m ≥ 0.

    Arguments: `a` = A, `e` = E and `m`; `start`, a guess; `step`, one of the above, and how many
    `steps` are taken. From above the root the iterates of both fall monotonically. The derivative
    is the implicit one, whatever the start.
    """
    root = start
    for _ in range(steps):
        root = step(root, a, e, m)
    return root


@positive_root.defjvp
def _implicit(step, steps, primals, tangents):
    a, e = primals[:2]
    d_a, d_e, d_m = tangents[:3]
    root = positive_root(*primals, step, steps)
    change = (d_e - d_a * root) * root + d_m
    return root, change / ((3 * root + 2 * a) * root - e)
