"""Adaptive quadrature over the unit cube, with arrays of fixed shapes for JAX.

The cube is cut into boxes (integrals/rules/boxes.py), each with an estimate of its error. The worst
boxes are halved until the total error is small enough or the allowed number of steps is used up.
Where halving reduces the error only by a factor ρ, as at a singularity, it would go on as a
geometric series, so the error is divided by 1 − ρ.
"""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate
from integrals.rules.boxes import LEAST_SIDE, Box, Boxes, first_places, measured
from integrals.rules.effort import Effort
from integrals.rules.product import product_rule

# Rounding of the weighted sum, in units of ε times the integral of |integrand|.
ROUNDINGS = 16

# Of a batch of integrals, this many are refined at once.
_AT_ONCE = 32

# The largest ρ that is believed.
_SLOWEST = 0.995


def adaptive(
    integrand: Callable[..., Array],
    edges: Callable[..., list[Array]],
    arguments: tuple[Array, ...],
    effort: Effort,
) -> Estimate:
    """Integrate `integrand(position, *arguments)` over the unit cube, position (k,).

    `edges(*arguments)` returns for each variable the ends of its segments: an increasing array from
    0 to 1 with the breaks in between. The derivative by `arguments` is that of the rule with the
    boxes held fixed within their segments. So it is right across a break that moves.
    """
    held = tuple(map(jax.lax.stop_gradient, arguments))
    boxes = _refined(integrand, edges, held, effort)

    @jax.custom_jvp
    def total(arguments, boxes):
        return jnp.sum(boxes.value)

    @total.defjvp
    def derivative(primals, tangents):
        arguments, boxes = primals

        def again(*arguments):
            ends = edges(*arguments)

            def value(place):
                box, (points, weights) = Box(ends, *place), product_rule(effort.nodes, len(ends))
                return box.volume * (
                    weights @ box.values(lambda x: integrand(x, *arguments), points)
                )

            return jnp.sum(jax.lax.map(value, (boxes.segment, boxes.lower, boxes.upper)))

        return total(arguments, boxes), jax.jvp(again, arguments, tangents[0])[1]

    rounding = ROUNDINGS * np.finfo(float).eps * jnp.sum(boxes.size)
    return Estimate(total(tuple(arguments), boxes), jnp.sum(boxes.error()) + rounding)


def _refined(integrand, edges, arguments: tuple[Array, ...], effort: Effort) -> Boxes:
    """Return the boxes after at most `effort.steps` steps, with empty ones in unused places.

    Under `jax.vmap`, each place of the batch takes as many steps as it needs by itself.
    """
    together = functools.partial(_refined_together, integrand, edges, effort)

    @jax.custom_batching.custom_vmap
    def refined(*arguments):
        return jax.tree.map(lambda x: x[0], together([x[None] for x in arguments]))

    @refined.def_vmap
    def refined_batch(size, batched, *arguments):
        pairs = zip(arguments, batched, strict=True)
        rows = [x if along else jnp.broadcast_to(x, (size, *x.shape)) for x, along in pairs]
        boxes = together(rows)
        return boxes, jax.tree.map(lambda _: True, boxes)

    return refined(*arguments)


def _refined_together(integrand, edges, effort: Effort, arguments: list[Array]) -> Boxes:
    """Return the boxes (batch, N, …) for arguments (batch, …).

    Most places of a batch need few steps. So each turn of the loop takes a step at `_AT_ONCE` of
    those that are not finished. With `jax.vmap`, all would take the steps that the slowest needs.
    """
    unfinished = jax.vmap(functools.partial(_unfinished, effort))
    halved = jax.vmap(functools.partial(_with_worst_halved, integrand, edges, effort))

    def turn(state):
        steps, going, boxes = state
        goes, chosen = jax.lax.top_k(going.astype(int), min(_AT_ONCE, len(going)))
        step = steps[chosen]
        old = jax.tree.map(lambda x: x[chosen], boxes)
        new = halved(step, old, *[x[chosen] for x in arguments])
        # What is written beyond the end is dropped.
        place = jnp.where(goes > 0, chosen, len(going))
        written = (steps, going, boxes), (step + 1, unfinished(step + 1, new), new)
        return jax.tree.map(lambda x, fresh: x.at[place].set(fresh, mode="drop"), *written)

    boxes = jax.vmap(functools.partial(_first, integrand, edges, effort))(*arguments)
    steps = jnp.zeros(len(boxes.value), int)
    state = steps, unfinished(steps, boxes), boxes
    return jax.lax.while_loop(lambda state: jnp.any(state[1]), turn, state)[2]


def _first(integrand, edges, effort: Effort, *arguments) -> Boxes:
    """Return the boxes at the start, with room for those of all steps."""
    ends = edges(*arguments)
    places = first_places([len(each) - 1 for each in ends], effort.panels)
    boxes = measured(integrand, arguments, ends, effort, *places)
    unused = effort.steps * effort.splits
    return jax.tree.map(
        lambda x: jnp.concatenate([x, jnp.zeros((unused, *x.shape[1:]), x.dtype)]), boxes
    )


def _unfinished(effort: Effort, step, boxes: Boxes) -> Array:
    """Return whether another step is allowed and needed."""
    small = jnp.sum(boxes.error()) <= effort.tolerance * jnp.sum(boxes.size)
    return (step < effort.steps) & ~small & (jnp.max(_priority(boxes)) > 0)


def _with_worst_halved(integrand, edges, effort: Effort, step, boxes: Boxes, *arguments) -> Boxes:
    """Return the boxes after a step, the first of which has the number 0."""
    ends = edges(*arguments)
    _, worst = jax.lax.top_k(_priority(boxes), effort.splits)
    segment, lower, upper = boxes.segment[worst], boxes.lower[worst], boxes.upper[worst]
    cut = jax.nn.one_hot(jnp.argmax(boxes.errors[worst], axis=1), len(ends)) > 0
    middle = (lower + upper) / 2
    below = (segment, lower, jnp.where(cut, middle, upper))
    above = (segment, jnp.where(cut, middle, lower), upper)
    both = [jnp.concatenate(pair) for pair in zip(below, above, strict=True)]
    halves = measured(integrand, arguments, ends, effort, *both)
    halves = _accepted(jax.tree.map(lambda x: x[worst], boxes), halves)
    first = len(boxes.value) - effort.steps * effort.splits
    fresh = first + step * effort.splits + jnp.arange(effort.splits)
    places = jnp.concatenate([worst, fresh])
    return jax.tree.map(lambda x, half: x.at[places].set(half), boxes, halves)


def _priority(boxes: Boxes) -> Array:
    """Return what is largest at the box to be halved next; 0 if none may be halved further."""
    error = boxes.error()
    error = jnp.where(jnp.isnan(error), jnp.inf, error)
    return jnp.where(boxes.side > LEAST_SIDE, error, 0.0)


def _accepted(whole: Boxes, halves: Boxes) -> Boxes:
    """Return what takes the place of n boxes: their 2n halves, all lower ones first.

    Where a half is not finite although the box is, a node met a singularity, or rounding in the
    integrand gave 0/0. Then the box stays, with its error, and is not halved again.
    """
    error, parts = jnp.sum(whole.errors, axis=1), jnp.sum(halves.errors, axis=1)
    sound = jnp.isfinite(whole.value + error)
    left, right = jnp.split(parts + jnp.abs(halves.value), 2)
    keep = jnp.tile(sound & ~jnp.isfinite(left + right), 2)
    left, right = jnp.split(parts, 2)
    known = sound & (error > 0) & jnp.isfinite(left + right)
    ratio = jnp.where(known, (left + right) / jnp.where(known, error, 1.0), 0.0)
    slowness = jnp.tile(1 / (1 - jnp.minimum(ratio, _SLOWEST)), 2)
    halves = halves._replace(slowness=slowness)
    kept = whole._replace(side=jnp.zeros_like(whole.side))
    instead = jax.tree.map(lambda x: jnp.concatenate([x, jnp.zeros_like(x)]), kept)

    def choose(half, other):
        return jnp.where(keep.reshape(-1, *[1] * (half.ndim - 1)), other, half)

    return jax.tree.map(choose, halves, instead)
