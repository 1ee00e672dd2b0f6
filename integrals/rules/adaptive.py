"""Adaptive quadrature over the unit cube, with arrays of fixed shapes for JAX.

The cube is cut into boxes, each with a product of Gauss–Legendre rules. The error of a box is the
sum of three parts:

* the difference to a rule with fewer nodes,
* the last Legendre coefficients of the integrand on the box: they are large if there is a kink, a
  jump or a singularity, wherever the nodes happen to be,
* at the faces, the difference between the integrand and the polynomial through the nodes: it finds
  a kink or a jump between the last nodes and the face.

The worst boxes are halved until the total error is small enough or the allowed number of steps is
used up. Where halving reduces the error only by a factor ρ, as at a singularity, it would go on as
a geometric series, so the error is divided by 1 − ρ.
"""

import functools
import itertools
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate
from integrals.rules.effort import Effort, fewer
from integrals.rules.interval import gauss_legendre
from integrals.rules.product import last_coefficients, product_rule, value_at_end

# Rounding of the weighted sum, in units of ε times the integral of |integrand|.
ROUNDINGS = 16

# A box is not halved further once its side is this small a part of the coordinate of its upper end:
# its nodes would be rounded to each other, or to the end. At 0 there is no such limit.
_LEAST_SIDE = 2.0**-40

# The largest ρ that is believed.
_SLOWEST = 0.995


class Boxes(NamedTuple):
    """N boxes in k variables: where they are, and the estimates of the rule on each.

    The breaks cut each variable into segments. `segment` (N, k) has the index of the box's segment.
    `lower` and `upper` (N, k) are its ends as fractions of the segment. `value` (N,) is the
    integral, `errors` (N, k) has a part for each variable, and `size` (N,) is the integral of
    |integrand|. `side` (N,) is the smallest side, as a part of the coordinate of its upper end.
    `slowness` (N,) is the factor 1/(1 − ρ) by which the errors have to be multiplied.
    """

    segment: Array
    lower: Array
    upper: Array
    value: Array
    errors: Array
    size: Array
    side: Array
    slowness: Array

    def error(self) -> Array:
        """Return the error of each box, (N,)."""
        return jnp.sum(self.errors, axis=1) * self.slowness


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
    boxes = _refined(lambda x: integrand(x, *held), edges(*held), effort)

    @jax.custom_jvp
    def total(arguments, boxes):
        return jnp.sum(boxes.value)

    @total.defjvp
    def derivative(primals, tangents):
        arguments, boxes = primals

        def again(*arguments):
            ends = edges(*arguments)

            def value(place):
                box, (points, weights) = _Box(ends, *place), product_rule(effort.nodes, len(ends))
                return box.volume * (
                    weights @ box.values(lambda x: integrand(x, *arguments), points)
                )

            return jnp.sum(jax.lax.map(value, (boxes.segment, boxes.lower, boxes.upper)))

        return total(arguments, boxes), jax.jvp(again, arguments, tangents[0])[1]

    rounding = ROUNDINGS * np.finfo(float).eps * jnp.sum(boxes.size)
    return Estimate(total(tuple(arguments), boxes), jnp.sum(boxes.error()) + rounding)


def _refined(integrand, edges: list[Array], effort: Effort) -> Boxes:
    """Return the boxes after at most `effort.steps` steps, with empty ones in unused places."""
    measure = jax.vmap(functools.partial(_measured, integrand, edges, effort.nodes))
    segment, lower, upper = _first_boxes([len(ends) - 1 for ends in edges], effort.panels)
    first = measure(segment, lower, upper)
    count = len(segment)
    unused = effort.steps * effort.splits
    boxes = jax.tree.map(
        lambda x: jnp.concatenate([x, jnp.zeros((unused, *x.shape[1:]), x.dtype)]), first
    )

    def priority(boxes):
        error = boxes.error()
        error = jnp.where(jnp.isnan(error), jnp.inf, error)
        return jnp.where(boxes.side > _LEAST_SIDE, error, 0.0)

    def unfinished(state):
        step, boxes = state
        small = jnp.sum(boxes.error()) <= effort.tolerance * jnp.sum(boxes.size)
        return (step < effort.steps) & ~small & (jnp.max(priority(boxes)) > 0)

    def halve_the_worst(state):
        step, boxes = state
        _, worst = jax.lax.top_k(priority(boxes), effort.splits)
        segment, lower, upper = boxes.segment[worst], boxes.lower[worst], boxes.upper[worst]
        cut = jax.nn.one_hot(jnp.argmax(boxes.errors[worst], axis=1), len(edges)) > 0
        middle = (lower + upper) / 2
        below = (segment, lower, jnp.where(cut, middle, upper))
        above = (segment, jnp.where(cut, middle, lower), upper)
        halves = measure(*(jnp.concatenate(pair) for pair in zip(below, above, strict=True)))
        whole = jax.tree.map(lambda x: x[worst], boxes)
        halves = _accepted(whole, halves)
        fresh = count + step * effort.splits + jnp.arange(effort.splits)
        places = jnp.concatenate([worst, fresh])
        return step + 1, jax.tree.map(lambda x, half: x.at[places].set(half), boxes, halves)

    return jax.lax.while_loop(unfinished, halve_the_worst, (0, boxes))[1]


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


def _first_boxes(segments: list[int], panels: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return segment, lower and upper, (N, k) each: at least `panels` boxes along each variable."""
    axes = []
    for count in segments:
        parts = -(-panels // count)
        axes.append([(s, i / parts, (i + 1) / parts) for s in range(count) for i in range(parts)])
    boxes = np.array(list(itertools.product(*axes)))  # (N, k, 3)
    return boxes[..., 0].astype(int), boxes[..., 1], boxes[..., 2]


def _measured(integrand, edges, nodes: int, segment, lower, upper) -> Boxes:
    """Return one box with the value, the errors and the size that the rules find on it."""
    box = _Box(edges, segment, lower, upper)
    variables = len(edges)
    points, weights = product_rule(nodes, variables)
    other_points, other_weights = product_rule(fewer(nodes), variables)
    across = product_rule(nodes, variables - 1)[1]
    # All in one call: JAX compiles the integrand once.
    every = np.concatenate([points, other_points, _face_points(nodes, variables)])
    found, other, faces = jnp.split(
        box.values(integrand, every), [len(points), len(points) + len(other_points)]
    )
    value = box.volume * (weights @ found)
    difference = jnp.abs(value - box.volume * (other_weights @ other))
    values = found.reshape((nodes,) * variables)
    faces = faces.reshape(variables, 2, 2, len(across))
    errors = []
    for variable in range(variables):
        last = jnp.tensordot(last_coefficients(nodes), values, axes=(1, variable))
        missed = jnp.max(jnp.abs(last), axis=0).reshape(-1)
        for face in (0, 1):
            expected = jnp.tensordot(value_at_end(nodes, face), values, axes=(0, variable))
            gap = jnp.abs(faces[variable, face] - expected.reshape(-1))
            # A value that is not finite is a singularity, which the coefficients find.
            gap = jnp.min(jnp.where(jnp.isfinite(gap), gap, 0.0), axis=0)
            missed = missed + gauss_legendre(nodes, 0.0, 1.0)[1][0] * gap
        errors.append(box.volume * (across @ missed) + difference / variables)
    size = box.volume * (weights @ jnp.abs(found))
    return Boxes(segment, lower, upper, value, jnp.stack(errors), size, box.side, jnp.ones(()))


def _face_points(nodes: int, variables: int) -> np.ndarray:
    """Return points for each variable, its two faces, and two distances from the face.

    One is on the face and one just inside, and the one closer to the expected value counts: with a
    jump on the face itself, the value there may be that of the neighbour.
    """
    across, _ = product_rule(nodes, variables - 1)
    return np.concatenate(
        [
            np.insert(across, variable, abs(face - inside), axis=1)
            for variable in range(variables)
            for face in (0, 1)
            for inside in (0.0, _LEAST_SIDE)
        ]
    )


class _Box:
    """A box of non-negative sides: its place, volume and smallest relative side."""

    def __init__(self, edges, segment, lower, upper):
        pairs = zip(edges, segment, strict=True)
        ends = jnp.stack([each[index + np.arange(2)] for each, index in pairs])
        begin, length = ends[:, 0], ends[:, 1] - ends[:, 0]
        corner, sides = begin + length * lower, length * (upper - lower)
        # The integrand may have no value at the place of an empty box: ask for values elsewhere.
        self.empty = jnp.any(sides <= 0)
        self.origin = jnp.where(self.empty, 0.0, corner)
        self.sides = jnp.where(self.empty, 1.0, sides)
        self.volume = jnp.where(self.empty, 0.0, jnp.prod(self.sides))
        relative = jnp.min(self.sides / (self.origin + self.sides))
        self.side = jnp.where(self.empty, 0.0, relative)

    def values(self, integrand, points: np.ndarray) -> Array:
        """Return the integrand at points (n, k), fractions of the box: zeros if it is empty."""
        found = jax.vmap(integrand)(self.origin + self.sides * points)
        return jnp.where(self.empty, 0.0, found)
