"""Smoothing of a mesh's curvature by Gaussians along its surface.

The talk blurs with an equal blend of two Gaussians, of 8 mm and 2.3 mm, after concave curvature was
clamped to zero. Its weights and distances are not stated. Here a tensor counts by its vertex's area
and a Gaussian of the straight distance, which is cut at `REACH` widths. It is carried to the other
tangent plane by the shortest rotation between the normals, and is left out if these are more than
90° apart, so that the back of a thin part does not count. For each width, vertices that are nearer
to each other than a part of the width are first joined to one sample, so that the time does not
grow with the square of the number of vertices.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from scipy.spatial import KDTree

from shadefit.curvature.blocks import over_rows
from shadefit.curvature.meshes import Mesh, same_rows
from shadefit.curvature.tensors import Curvature, frames_of
from shading.curvature import carried, convex_part

# The widths σ of the talk in mm, with equal weights.
WIDTHS = (8.0, 2.3)
REACH = 3.0
# The size of the cells of which samples are made, as a part of the width.
CELL = 1 / 2
_VERTICES_AT_ONCE = 8192


@dataclass(frozen=True)
class _Samples:
    places: np.ndarray
    frames: np.ndarray
    normals: np.ndarray
    tensors: np.ndarray
    areas: np.ndarray


def convex(found: Curvature) -> Curvature:
    """Return curvature whose concave parts are zero: eigenvalues below zero are clamped."""
    return replace(found, tensors=over_rows(_convex, found.tensors)[0])


def smoothed(mesh: Mesh, found: Curvature, widths: Sequence[float] = WIDTHS) -> Curvature:
    """Return the mean of the curvature blurred by a Gaussian of each width σ in mm.

    A vertex without area near to it keeps its tensor. Raises ValueError for no width, and for
    widths that are not positive.
    """
    if not widths or not all(0 < width < np.inf for width in widths):
        raise ValueError(f"widths = {list(widths)}: allowed are positive numbers of mm")
    total = sum(_blurred(mesh, found, width) for width in widths)
    return replace(found, tensors=total / len(widths))


def _blurred(mesh: Mesh, found: Curvature, width: float) -> np.ndarray:
    samples = _samples(mesh, found, width * CELL)
    tree = KDTree(samples.places)
    result = np.empty_like(found.tensors)
    for start in range(0, len(result), _VERTICES_AT_ONCE):
        rows = slice(start, min(start + _VERTICES_AT_ONCE, len(result)))
        near = tree.query_ball_point(mesh.vertices[rows], REACH * width)
        count = np.array([len(each) for each in near])
        vertex = np.repeat(np.arange(rows.start, rows.stop), count)
        sample = np.concatenate([np.asarray(each, np.int64) for each in near])
        distance = mesh.vertices[vertex] - samples.places[sample]
        weight = samples.areas[sample] * np.exp(-np.sum(distance**2, 1) / (2 * width**2))
        facing = np.sum(mesh.normals[vertex] * samples.normals[sample], 1) > 0
        vertex, sample, weight = vertex[facing], sample[facing], weight[facing]
        (moved,) = over_rows(
            _carried, samples.tensors[sample], samples.frames[sample], found.frames[vertex]
        )
        own, size = vertex - rows.start, rows.stop - rows.start
        mass = np.bincount(own, weight, size)
        sums = np.stack([np.bincount(own, weight * each, size) for each in moved.T], 1)
        known = (mass > 0)[:, None]
        blurred = sums / np.where(known, mass[:, None], 1.0)
        result[rows] = np.where(known, blurred, found.tensors[rows])
    return result


def _samples(mesh: Mesh, found: Curvature, cell: float) -> _Samples:
    """Return a sample for all vertices with area in a cell whose normals have the same signs."""
    used = found.areas > 0
    # Copies of a vertex at a seam have the area of the whole vertex each.
    whole = np.column_stack([mesh.vertices, mesh.normals])
    _, first = np.unique(same_rows(whole), return_index=True)
    kept = np.zeros_like(used)
    kept[first] = True
    kept &= used
    places, normals, areas = mesh.vertices[kept], mesh.normals[kept], found.areas[kept]
    if not len(places):
        return _Samples(
            np.zeros((1, 3)), found.frames[:1], mesh.normals[:1], found.tensors[:1], np.zeros(1)
        )
    keys = np.column_stack([np.floor(places / cell), normals >= 0])
    cells = same_rows(keys.astype(float))
    count = cells.max() + 1
    area = np.bincount(cells, areas, count)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(cells, areas * v, count) for v in values.T], 1) / area[:, None]

    # Normals with the same signs never cancel out.
    direction = mean(normals)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    frames = frames_of(direction)
    (moved,) = over_rows(_carried, found.tensors[kept], found.frames[kept], frames[cells])
    return _Samples(mean(places), frames, direction, mean(moved), area)


def _convex(tensor: jax.Array) -> tuple[jax.Array]:
    return (convex_part(tensor),)


def _carried(tensor: jax.Array, frame: jax.Array, other: jax.Array) -> tuple[jax.Array]:
    return (jnp.asarray(carried(tensor, frame, other)),)
