"""Roots of increasing functions, in a fixed number of steps and with derivatives."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array

from shading.types import Scalar

# Newton's steps double the digits, except near a place where the slope vanishes: there each step
# halves the distance, as a bisection does. 48 steps reach the last digits of float64 in both cases.
STEPS = 48
# In units of the first bracket: what rounding may move a step of Newton out of a later one. Near
# the root, a compiler that fuses operations may find the sign and the size of the gap differently;
# a bisection would then leave the root.
MARGIN = 1e-5


def increasing_root(
    of: Callable[[Array, Any], tuple[Array, Array]],
    parameters: Any,
    goal: Scalar,
    lower: Scalar,
    upper: Scalar,
    *,
    steps: int = STEPS,
) -> Array:
    """Return x in [lower, upper] with f(x) = goal, for a function that does not decrease there.

    `of(x, parameters)` returns f(x) and its derivative. Every step is Newton's, or a bisection if
    that would leave the bracket by more than rounding does. The number of steps is fixed, so that
    it ends in any precision. The result has derivatives with respect to `parameters` (a pytree) and
    `goal`.
    """
    held = jax.lax.stop_gradient(parameters)
    aim = jax.lax.stop_gradient(jnp.asarray(goal))
    low, high = (jax.lax.stop_gradient(jnp.asarray(each, float)) for each in (lower, upper))

    margin = MARGIN * (high - low)

    def step(_, state):
        low, high, x = state
        value, slope = of(x, held)
        gap = value - aim
        low, high = jnp.where(gap <= 0, x, low), jnp.where(gap <= 0, high, x)
        moved = x - gap / jnp.where(slope > 0, slope, 1.0)
        inside = (slope > 0) & (moved >= low - margin) & (moved <= high + margin)
        return low, high, jnp.where(inside, jnp.clip(moved, low, high), (low + high) / 2)

    _, _, x = jax.lax.fori_loop(0, steps, step, (low, high, (low + high) / 2))
    x = jax.lax.stop_gradient(x)
    # One more step of Newton, which moves x by rounding only, carries the derivatives.
    value, slope = of(x, parameters)
    slope = jax.lax.stop_gradient(slope)
    moved = x - (value - goal) / jnp.where(slope > 0, slope, 1.0)
    return jnp.clip(jnp.where(slope > 0, moved, x), low, high)
