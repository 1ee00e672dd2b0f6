"""The positive root of the cubic in the closed form of P_s, differentiable on the closed domain."""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import Array

Step = Callable[[Array, Array, Array, Array], Array]


@jax.custom_jvp
def at_least(value: Array, bound: Array | float) -> Array:
    """Return the larger of `value` and `bound`, with the derivative of `value` in either case.

    Use it for a bound that is true of the exact value. Then the value is below the bound only
    because of rounding, at points where the exact value equals the bound. The derivative of the
    bound would be wrong there, and so would the mean of both that `jnp.maximum` returns.
    """
    return jnp.where(value < bound, bound, value)


@at_least.defjvp
def _own_derivative(primals, tangents):
    return at_least(*primals), tangents[0]


@jax.custom_jvp
def magnitude(value: Array) -> Array:
    """Return |value|, with the derivative of `value`. Use it if only rounding makes it negative."""
    return jnp.abs(value)


magnitude.defjvp(lambda primals, tangents: (magnitude(*primals), tangents[0]))


def newton_step(root: Array, a: Array, e: Array, m: Array) -> Array:
    """Return the next iterate of Newton's method for the cubic f of `positive_root`.

    A relative error ε > 0 becomes at most 2ε². λ − f/f′ is written as one fraction, whose numerator
    is a sum of positive terms.
    """
    product = (root + a) * root
    rising = root * root + product
    return (rising * root + m) / (rising + (product - e))


def tangent_step(root: Array, a: Array, e: Array, m: Array) -> Array:
    """Return the next iterate of a method that also converges from a start far above the root.

    It replaces λ² in λ·λ² by its tangent 2sλ − s² at the last iterate s, and solves the quadratic
    equation that remains. Convergence is quadratic.
    """
    b, d = root + root + a, e + root * root
    return (d + jnp.sqrt(d * d + 4 * b * m)) / (b + b)


@functools.partial(jax.custom_jvp, nondiff_argnums=(4, 5))
def positive_root(a: Array, e: Array, m: Array, start: Array, step: Step, steps: int) -> Array:
    """Return the largest root of f(λ) = λ³ + Aλ² − Eλ − m, where m ≥ 0 and one root is positive.

    `a`, `e` and `m` are the coefficients A, E and m. `start` is a guess of the root, `step` is
    `newton_step` or `tangent_step`, and `steps` is how often it is applied. From a start above the
    root, the iterates of both decrease towards it. The derivative is that of the implicit equation
    f = 0, and does not depend on the start.
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
