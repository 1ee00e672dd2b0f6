"""Boxes within the unit cube, each with a product of Gauss–Legendre rules.

The error of a box is the sum of three parts:

* the difference to a rule with fewer nodes,
* the last Legendre coefficients of the integrand on the box: they are large if there is a kink, a
  jump or a singularity, wherever the nodes happen to be,
* at the faces, the difference between the integrand and the polynomial through the nodes: it finds
  a kink or a jump between the last nodes and the face.
"""

import functools
import itertools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.rules.effort import Effort, fewer
from integrals.rules.interval import gauss_legendre
from integrals.rules.product import last_coefficients, product_rule, value_at_end

# A box is not halved further once its side is this small a part of the coordinate of its upper end:
# its nodes would be rounded to each other, or to the end. At 0 there is no such limit.
LEAST_SIDE = 2.0**-40


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


def first_places(segments: list[int], panels: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return segment, lower and upper, (N, k) each: at least `panels` boxes along each variable."""
    axes = []
    for count in segments:
        parts = -(-panels // count)
        axes.append([(s, i / parts, (i + 1) / parts) for s in range(count) for i in range(parts)])
    boxes = np.array(list(itertools.product(*axes)))  # (N, k, 3)
    return boxes[..., 0].astype(int), boxes[..., 1], boxes[..., 2]


def measured(integrand, arguments, edges, effort: Effort, segments, lowers, uppers) -> Boxes:
    """Return boxes, whose places are (N, k) each, with what the rules find on them."""
    on_box = functools.partial(_on_box, lambda x: integrand(x, *arguments), edges, effort.nodes)
    return jax.vmap(on_box)(segments, lowers, uppers)


def _on_box(integrand, edges, nodes: int, segment, lower, upper) -> Boxes:
    """Return one box with the value, the errors and the size that the rules find on it."""
    box = Box(edges, segment, lower, upper)
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
            for inside in (0.0, LEAST_SIDE)
        ]
    )


class Box:
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
