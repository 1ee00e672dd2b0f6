"""Triangle meshes in mm: what a mesh must be, and what is counted where it is not."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

Points = Float[np.ndarray, "n 3"]
Triangles = Int[np.ndarray, "m 3"]
# What a unit of a mesh is in mm.
UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
LARGEST_COUNT = 20_000_000


@dataclass(frozen=True)
class Mesh:
    """A mesh in mm: vertices (n, 3), triangles (m, 3) of their numbers, unit normals (n, 3).

    `made_normals` counts the normals that were not given, or were no directions, and were computed.
    """

    vertices: Points
    triangles: Triangles
    normals: Points
    made_normals: int = 0


def mesh(
    vertices: np.ndarray,
    triangles: np.ndarray,
    normals: np.ndarray | None = None,
    *,
    unit: str,
) -> Mesh:
    """Return a mesh in mm of vertices (n, 3), in a unit of `UNITS`, and triangles (m, 3).

    Triangles are numbers of vertices. `normals` (n, 3) are normalised. Those that are missing, zero
    or not finite are computed by `vertex_normals`. Raises ValueError for vertices that are not
    finite, for numbers of vertices that do not exist, and for no triangle or too many.
    """
    if unit not in UNITS:
        raise ValueError(f"unit {unit!r} is not known: allowed are {', '.join(UNITS)}")
    places = np.asarray(vertices, float)
    corners = np.asarray(triangles)
    for name, array in (("vertices", places), ("triangles", corners)):
        if array.ndim != 2 or array.shape[1] != 3 or not 1 <= len(array) <= LARGEST_COUNT:
            raise ValueError(
                f"{name} have the shape {array.shape}: allowed is (n, 3), n from 1 to "
                f"{LARGEST_COUNT}"
            )
    if corners.dtype.kind not in "iu" or corners.min() < 0 or corners.max() >= len(places):
        raise ValueError(f"triangles: allowed are whole numbers from 0 to {len(places) - 1}")
    bad = np.flatnonzero(~np.isfinite(places).all(1) | (np.abs(places).max(1) > 1e12))
    if len(bad):
        raise ValueError(
            f"vertex {bad[0]} is {places[bad[0]].tolist()}, and {len(bad) - 1} more: allowed are "
            "finite numbers up to 1e12"
        )
    places, corners = places * UNITS[unit], corners.astype(np.int64)
    given = np.zeros_like(places) if normals is None else np.asarray(normals, float)
    if given.shape != places.shape:
        raise ValueError(f"normals have the shape {given.shape}: allowed is {places.shape}")
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.linalg.norm(given, axis=1)
        missing = ~(np.isfinite(lengths) & (lengths > 1e-12))
    directions = given / np.where(missing, 1.0, lengths)[:, None]
    if missing.any():
        directions[missing] = vertex_normals(places, corners)[missing]
    return Mesh(places, corners, directions, int(missing.sum()))


def vertex_normals(vertices: Points, triangles: Triangles) -> Points:
    """Return unit normals of vertices by the weights of Max 1999, which are exact on spheres.

    Vertices at the same place have one normal. Where there is no direction, it is (0, 0, 1).
    """
    place = same_rows(vertices)
    corners = vertices[triangles]
    total = np.zeros((place.max() + 1, 3))
    for k in range(3):
        one = corners[:, (k + 1) % 3] - corners[:, k]
        other = corners[:, (k + 2) % 3] - corners[:, k]
        lengths2 = np.sum(one * one, 1) * np.sum(other * other, 1)
        weighted = np.cross(one, other) / np.where(lengths2 > 0, lengths2, 1.0)[:, None]
        total += _summed(place[triangles[:, k]], weighted, len(total))
    lengths = np.linalg.norm(total, axis=1)
    none = ~(lengths > 0)
    total[none] = (0.0, 0.0, 1.0)
    return (total / np.where(none, 1.0, lengths)[:, None])[place]


def non_manifold_edges(triangles: Triangles) -> int:
    """Count the edges that more than two triangles have."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    keys = edges[:, 0] * (triangles.max() + 1) + edges[:, 1]
    return int(np.sum(np.unique(keys, return_counts=True)[1] > 2))


def same_rows(rows: np.ndarray) -> np.ndarray:
    """Return a number (n,) for each row of (n, k): equal rows have the same number, from 0 on."""
    # As bytes, rows are sorted much faster; −0 becomes 0 first.
    whole = np.ascontiguousarray(rows + 0.0)
    keys = whole.view(np.dtype((np.void, whole.dtype.itemsize * whole.shape[1]))).ravel()
    return np.unique(keys, return_inverse=True)[1].reshape(-1)


def _summed(places: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    return np.stack([np.bincount(places, each, count) for each in values.T], axis=1)
