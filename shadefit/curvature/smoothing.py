"""Smoothing of a mesh's curvature by Gaussians along its surface, and the drift of its normals.

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
import numpy as np
from jaxtyping import Float

from shadefit.curvature.blocks import over_rows
from shadefit.curvature.gaussian_sums import CUT_VARIANCE, Samples, Sums, gaussian_sums, in_plane
from shadefit.curvature.meshes import Mesh, same_rows
from shadefit.curvature.tensors import Curvature, frames_of, space_tensors
from shading.curvature import convex_part

# The widths σ of the talk in mm, with equal weights.
WIDTHS = (8.0, 2.3)
# The width σ in mm of the blurred normals that the drift is made of, near that of red light in skin
DRIFT_WIDTH = 1.4
# The size of the cells of which samples are made, as a part of the width.
CELL = 1 / 3


@dataclass(frozen=True)
class _Distinct:
    """The vertices that differ in place or normal: `first` of each, and `number` of every vertex.

    Copies of a vertex at a seam have the area of the whole vertex each.
    """

    first: np.ndarray
    number: np.ndarray


def convex(found: Curvature) -> Curvature:
    """Return curvature whose concave parts are zero: eigenvalues below zero are clamped."""
    return replace(found, tensors=convex_tensors(found.tensors))


def convex_tensors(tensors: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Return tensors whose eigenvalues below zero are zero instead."""
    return over_rows(_convex, tensors)[0]


def smoothed(
    mesh: Mesh, found: Curvature, widths: Sequence[float] = WIDTHS, cell: float = CELL
) -> Curvature:
    """Return the mean of the curvature blurred by a Gaussian of each width σ in mm.

    `cell` is the size of the cells of which samples are made, as a part of each width. A vertex
    without area near to it keeps its tensor. Raises ValueError for no width, and for widths and
    cells that are not positive.
    """
    if not widths:
        raise ValueError("widths = []: allowed are positive numbers of mm")
    distinct = _distinct(mesh)
    total = np.zeros_like(found.tensors)
    for width in widths:
        total += _tensors(found, distinct, _sums(mesh, found, distinct, width, cell))
    return replace(found, tensors=total / len(widths))


def normal_drift(
    mesh: Mesh, found: Curvature, width: float = DRIFT_WIDTH, cell: float = CELL
) -> Float[np.ndarray, "n 2"]:
    """Return how the blurred normal leans, in 1/mm², in the frames of the curvature.

    It is the part along the surface of the mean normal of a Gaussian of `width` σ in mm, divided by
    the Gaussian's variance. Where the mean place of the Gaussian is not the vertex, since vertices
    are not even or the mesh ends, the normal that the tensor has there is taken off. It is zero for
    a vertex without area near to it. For small widths it is half the gradient of the tensor's
    trace; `shading.curvature.drifted` takes it.
    """
    distinct = _distinct(mesh)
    return _drift(mesh, found, distinct, _sums(mesh, found, distinct, width, cell), width)


def smoothed_with_drift(
    mesh: Mesh, found: Curvature, width: float = DRIFT_WIDTH, cell: float = CELL
) -> tuple[Curvature, Float[np.ndarray, "n 2"]]:
    """Return `smoothed` of one width and `normal_drift` in the time of one of them."""
    distinct = _distinct(mesh)
    sums = _sums(mesh, found, distinct, width, cell)
    drift = _drift(mesh, found, distinct, sums, width)
    return replace(found, tensors=_tensors(found, distinct, sums)), drift


def _tensors(found: Curvature, distinct: _Distinct, sums: Sums) -> np.ndarray:
    known = (sums.mass > 0)[distinct.number]
    return np.where(known[:, None], sums.tensors[distinct.number], found.tensors)


def _drift(
    mesh: Mesh, found: Curvature, distinct: _Distinct, sums: Sums, width: float
) -> np.ndarray:
    apart = sums.places[distinct.number] - mesh.vertices
    leaning = np.einsum("nai,ni->na", found.frames, sums.normals[distinct.number])
    x, y = np.einsum("nai,ni->an", found.frames, apart)
    xx, xy, yy = found.tensors.T
    bent = np.stack([xx * x + xy * y, xy * x + yy * y], axis=1)
    known = (sums.mass > 0)[distinct.number]
    return np.where(known[:, None], leaning - bent, 0.0) / (CUT_VARIANCE * width**2)


def _distinct(mesh: Mesh) -> _Distinct:
    number = same_rows(np.column_stack([mesh.vertices, mesh.normals]))
    return _Distinct(np.unique(number, return_index=True)[1], number)


def _sums(mesh: Mesh, found: Curvature, distinct: _Distinct, width: float, cell: float) -> Sums:
    """Return the means around the distinct vertices."""
    for name, value in (("widths", width), ("cell", cell)):
        if not 0 < value < np.inf:
            raise ValueError(f"{name} = {value:g}: allowed are positive numbers")
    first = distinct.first
    samples = _samples(mesh, found, first[found.areas[first] > 0], width * cell)
    return gaussian_sums(samples, mesh.vertices[first], found.frames[first], width)


def _samples(mesh: Mesh, found: Curvature, used: np.ndarray, cell: float) -> Samples:
    """Return a sample for all used vertices in a cell whose normals have the same signs."""
    places, normals, areas = mesh.vertices[used], mesh.normals[used], found.areas[used]
    keys = np.column_stack([np.floor(places / cell), normals >= 0])
    cells = same_rows(keys.astype(float))
    count = cells.max() + 1 if len(cells) else 0
    area = np.bincount(cells, areas, count).astype(float)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(cells, areas * v, count) for v in values.T], 1) / area[:, None]

    # Normals with the same signs never cancel out.
    leaning = mean(normals)
    directions = leaning / np.linalg.norm(leaning, axis=1)[:, None]
    frames = frames_of(directions) if count else np.zeros((0, 2, 3))
    matrices = space_tensors(found.tensors[used], found.frames[used])
    moved = mean(in_plane(matrices, normals, frames[cells], directions[cells]))
    return Samples(mean(places), directions, leaning, space_tensors(moved, frames), area)


def _convex(tensor: jax.Array) -> tuple[jax.Array]:
    return (convex_part(tensor),)
