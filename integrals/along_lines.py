"""Exact values at many points of few lines, by interpolation between exact values on each line.

The points of a texture or of a grid lie on lines: all their arguments but one are the same. Along a
line a smooth quantity is a polynomial to within its stated error, so that a few values of the
integral give all others.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from integrals.reference import Estimate, Reference, Smooth

# The numbers of nodes that are tried, and the least number of points for each node of a line.
_COUNTS, _POINTS_A_NODE = (17, 33, 65, 129), 2
# Interpolation may add this to the error of a value, or as much as the error is.
TOLERANCE = 1e-9
# The Lebesgue constants of these nodes: interpolation multiplies errors at the nodes by no more.
_LEBESGUE = {17: 2.73, 33: 3.17, 65: 3.61, 129: 4.06}

Evaluate = Callable[[np.ndarray], Estimate]


def estimates_along_lines(
    reference: Reference, smooth: Smooth, points: np.ndarray, exact: Evaluate
) -> Estimate:
    """Evaluate a quantity at points (n, axes), with n > 0; `exact` does so point by point.

    The quantity is smooth along the axis of `smooth`. On each line along it that has enough of the
    points, the values are those of the polynomial through 17 to 129 exact values, in the argument
    or its logarithm. Its error is at most the difference from the polynomial through every other
    one of them, because its coefficients fall geometrically. Where this is above `TOLERANCE` and
    above the errors of the exact values, and on all other lines, each point is evaluated by itself.
    Returns values and errors, (n,) each.
    """
    along = [axis.name for axis in reference.axes].index(smooth.axis)
    value, error = np.empty(len(points)), np.empty(len(points))
    inside = reference.axes[along].contains(points[:, along])
    lines, members = _lines(points, along)
    places = _places(smooth, np.where(inside, points[:, along], np.nan))
    rest, done = np.arange(len(lines)), np.zeros(len(lines), dtype=bool)
    found = _OnNodes(np.zeros((len(lines), 0)), np.zeros((len(lines), 0)))
    for count in _COUNTS:
        enough = np.array([len(members[k]) >= count * _POINTS_A_NODE for k in rest], dtype=bool)
        chosen, found = rest[enough], _OnNodes(found.value[enough], found.error[enough])
        if not len(chosen):
            break
        nodes = _nodes(count)
        at_nodes = _arguments(smooth, points[inside, along], nodes)
        found = _evaluated(found, lines[chosen], along, at_nodes, exact)
        between = _matrix(nodes[::2], nodes[1::2])
        added = np.abs(found.value[:, ::2] @ between.T - found.value[:, 1::2]).max(axis=1)
        stated = found.error.max(axis=1)
        holds = added <= np.maximum(TOLERANCE, stated)
        matrices: dict[bytes, np.ndarray] = {}
        for k in np.flatnonzero(holds):
            own = members[chosen[k]]
            # The lines of a grid have their points at the same places.
            same = places[own].tobytes()
            if same not in matrices:
                matrices = {same: _matrix(nodes, places[own])}
            value[own] = matrices[same] @ found.value[k]
            error[own] = _LEBESGUE[count] * stated[k] + added[k]
        rest, found = chosen[~holds], _OnNodes(found.value[~holds], found.error[~holds])
        done[chosen[holds]] = True
    rest = np.flatnonzero(~done)
    if len(rest):
        own = np.concatenate([members[k] for k in rest])
        alone = exact(points[own])
        value[own], error[own] = np.asarray(alone.value), np.asarray(alone.error)
    value[~inside] = error[~inside] = np.nan
    return Estimate(jnp.asarray(value), jnp.asarray(error))


class _OnNodes(NamedTuple):
    """Exact values and their errors at the nodes of lines, (lines, nodes) each."""

    value: np.ndarray
    error: np.ndarray


def _evaluated(
    known: _OnNodes, lines: np.ndarray, along: int, nodes: np.ndarray, exact: Evaluate
) -> _OnNodes:
    """Evaluate lines at nodes; where `known` has any, it has those at every other node."""
    fresh = nodes[1::2] if known.value.shape[1] else nodes
    at = np.repeat(lines, len(fresh), axis=0)
    at[:, along] = np.tile(fresh, len(lines))
    found = exact(at)
    value, error = (np.asarray(each).reshape(-1, len(fresh)) for each in (found.value, found.error))
    if len(fresh) == len(nodes):
        return _OnNodes(value, error)
    both = _OnNodes(np.empty((len(lines), len(nodes))), np.empty((len(lines), len(nodes))))
    for whole, even, odd in zip(both, known, (value, error), strict=True):
        whole[:, ::2], whole[:, 1::2] = even, odd
    return both


def _lines(points: np.ndarray, along: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return a point of each line, and the numbers of the points that lie on each."""
    _, first, line = np.unique(
        np.delete(points, along, axis=1), axis=0, return_index=True, return_inverse=True
    )
    order = np.argsort(line, kind="stable")
    ends = np.cumsum(np.bincount(line.ravel()))[:-1]
    return points[first], np.split(order, ends)


def _nodes(count: int) -> np.ndarray:
    """Return Chebyshev's points on [0, 1], both ends included."""
    return (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2


def _places(smooth: Smooth, x: np.ndarray) -> np.ndarray:
    """Map arguments, or their logarithms, to [0, 1], of which both ends are reached."""
    y = np.log(x) if smooth.logarithmic else x
    low, high = np.nanmin(y, initial=np.inf), np.nanmax(y, initial=-np.inf)
    return (y - low) / (high - low) if low < high else np.zeros(len(y))


def _arguments(smooth: Smooth, x: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the arguments at `places` between the least and the largest of x."""
    low, high = x.min(), x.max()
    if smooth.logarithmic:
        between = low * np.exp(np.log(high / low) * places)
    else:
        between = low + (high - low) * places
    return np.clip(between, low, high)


def _matrix(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the matrix (n, nodes) that maps values at Chebyshev's points to values at x (n,)."""
    signs = np.where(np.arange(len(nodes)) % 2, -1.0, 1.0)
    signs[[0, -1]] /= 2
    apart = x[:, None] - nodes
    at_node = apart == 0
    weights = signs / np.where(at_node, 1.0, apart)
    weights = np.where(at_node.any(axis=1, keepdims=True), at_node, weights)
    return weights / weights.sum(axis=1, keepdims=True)
