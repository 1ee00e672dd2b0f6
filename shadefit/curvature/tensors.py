"""Curvature tensors of a mesh: of its vertices, in other frames, and as space tensors."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from shadefit.curvature.blocks import over_rows
from shadefit.curvature.meshes import Mesh, non_manifold_edges, same_rows
from shading.curvature import corner_tensors, expressed, tangent_frame

Tensors = Float[np.ndarray, "n 3"]
Frames = Float[np.ndarray, "n 2 3"]


@dataclass(frozen=True)
class Curvature:
    """The curvature of a mesh: `tensors` (n, 3) in 1/mm in `frames` (n, 2, 3), a row for a vertex.

    * `areas` (n,): the mixed Voronoi areas in mm² by which triangles were weighted.
    * `degenerate`: the number of triangles without area, which were left out.
    * `isolated`: the number of vertices without any sound triangle, whose tensors are zero.
    * `non_manifold`: the number of edges of more than two triangles. All triangles count there.
    """

    tensors: Tensors
    frames: Frames
    areas: Float[np.ndarray, " n"]
    degenerate: int = 0
    isolated: int = 0
    non_manifold: int = 0


def curvature(mesh: Mesh) -> Curvature:
    """Return the curvature of a mesh by Rusinkiewicz' method.

    The tensor of each triangle is carried to its corners' tangent planes by the shortest rotation,
    and averaged there by mixed Voronoi areas. Vertices with the same place and normal, as files
    have them at seams of texture coordinates, are one vertex in this. Frames are those of
    `shading.curvature.tangent_frame`.
    """
    shared = same_rows(np.concatenate([mesh.vertices, mesh.normals], axis=1))
    count = int(shared.max()) + 1
    corners = shared[mesh.triangles]
    tensors, areas, sound = over_rows(
        _corners, mesh.vertices[mesh.triangles], mesh.normals[mesh.triangles]
    )
    place, weight = corners.ravel(), areas.ravel()
    total = np.bincount(place, weight, count)
    sums = [np.bincount(place, weight * each, count) for each in tensors.reshape(-1, 3).T]
    known = total > 0
    mean = np.stack(sums, axis=1) / np.where(known, total, 1.0)[:, None]
    return Curvature(
        mean[shared],
        frames_of(mesh.normals),
        total[shared],
        int(np.sum(~sound)),
        int(np.sum(~known[shared])),
        non_manifold_edges(corners),
    )


def frames_of(normals: Float[np.ndarray, "n 3"]) -> Frames:
    """Return the frames (n, 2, 3) that are computed from unit normals (n, 3) alone."""
    return over_rows(_frame, normals)[0]


def in_frames(found: Curvature, tangents: Float[np.ndarray, "n 3"]) -> Curvature:
    """Return curvature in frames with other tangents, such as those of texture coordinates.

    The part of a tangent along the normal is taken off. The bitangent is n × t. Raises ValueError
    for a tangent without a direction in its plane.
    """
    normals = np.cross(found.frames[:, 0], found.frames[:, 1])
    flat = tangents - np.sum(tangents * normals, 1)[:, None] * normals
    lengths = np.linalg.norm(flat, axis=1)
    bad = np.flatnonzero(~(lengths > 1e-12))
    if len(bad):
        raise ValueError(
            f"tangent {bad[0]} is {tangents[bad[0]].tolist()}: allowed are directions that are not "
            "along the normal"
        )
    flat = flat / lengths[:, None]
    frames = np.stack([flat, np.cross(normals, flat)], axis=1)
    return Curvature(
        over_rows(_expressed, found.tensors, found.frames, frames)[0],
        frames,
        found.areas,
        found.degenerate,
        found.isolated,
        found.non_manifold,
    )


def space_tensors(tensors: Tensors, frames: Frames) -> Float[np.ndarray, "n 3 3"]:
    """Return tensors as matrices (n, 3, 3) of space, which need no frame."""
    matrices = tensors[:, [[0, 1], [1, 2]]]
    return frames.transpose(0, 2, 1) @ matrices @ frames


def frame_tensors(matrices: Float[np.ndarray, "n 3 3"], frames: Frames) -> Tensors:
    """Return the tensors (n, 3) in frames of matrices (n, 3, 3) of space."""
    found = frames @ matrices @ frames.transpose(0, 2, 1)
    return found[:, [0, 0, 1], [0, 1, 1]]


def _corners(corners: jax.Array, normals: jax.Array) -> tuple[jax.Array, ...]:
    return corner_tensors(corners, normals)


def _frame(normal: jax.Array) -> tuple[jax.Array]:
    return (tangent_frame(normal),)


def _expressed(tensor: jax.Array, frame: jax.Array, other: jax.Array) -> tuple[jax.Array]:
    return (jnp.asarray(expressed(tensor, frame, other)),)
