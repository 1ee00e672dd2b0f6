"""Meshes of surfaces whose curvature is known, with exact normals, for tests and pictures."""

import numpy as np

from shadefit.curvature.meshes import Mesh, mesh
from shadefit.curvature.surfaces import (
    Ellipsoid,
    Finger,
    Surface,
    Torus,
    normals_and_tensors,
    torus_points,
)


def icosphere(radius: float, level: int) -> Mesh:
    """Return a sphere of 20·4^level triangles: an icosahedron that is divided `level` times."""
    return ellipsoid((radius, radius, radius), level)


def ellipsoid(axes: tuple[float, float, float], level: int) -> Mesh:
    """Return an ellipsoid with half axes in mm: an icosphere that is stretched."""
    directions, triangles = _unit_icosphere(level)
    return _of(Ellipsoid(axes), directions * axes, triangles)


def torus(
    major: float, minor: float, around: int, along: int, jitter: float = 0.0, seed: int = 0
) -> Mesh:
    """Return a torus of 2·around·along triangles; `around` counts those around its axis.

    `jitter` moves the vertices on the surface by up to that part of a cell in each direction.
    """
    if around < 3 or along < 3:
        raise ValueError(f"a torus of {around} × {along} cells: allowed are 3 or more")
    random = np.random.default_rng(seed)
    cells = np.stack(np.meshgrid(np.arange(around), np.arange(along), indexing="ij"), -1)
    moved = cells + jitter * random.uniform(-1, 1, cells.shape)
    angles = 2 * np.pi * moved / [around, along]
    surface = Torus(major, minor)
    points = torus_points(surface, angles[..., 0].ravel(), angles[..., 1].ravel())
    return _of(surface, points, _grid(around, along, True, True))


def cylinder(radius: float, length: float, around: int, along: int) -> Mesh:
    """Return an open cylinder along x of 2·around·along triangles."""
    angles = 2 * np.pi * np.arange(around) / around
    places = np.linspace(-length / 2, length / 2, along + 1)
    x, angle = np.meshgrid(places, angles, indexing="ij")
    points = np.stack([x, radius * np.cos(angle), radius * np.sin(angle)], -1).reshape(-1, 3)
    return _of(Finger(radius, length / 2), points, _grid(along + 1, around, False, True))


def finger(radius: float, half: float, around: int) -> Mesh:
    """Return a capsule along x, whose cylinder is 2·half long, with `around` vertices around it."""
    if around < 8:
        raise ValueError(f"{around} vertices around a finger: allowed are 8 or more")
    turn = np.linspace(0, np.pi, around // 2 + 1)[1:-1]
    caps = np.column_stack([-radius * np.cos(turn), radius * np.sin(turn)])
    step = 2 * np.pi * radius / around
    straight = np.linspace(-half, half, max(2, round(2 * half / step) + 1))
    back, front = caps[caps[:, 0] < -1e-9 * radius], caps[caps[:, 0] > 1e-9 * radius]
    shift = np.array([half, 0.0])
    ends = [back - shift, front + shift]
    middle = np.column_stack([straight, np.full(len(straight), radius)])
    profile = np.concatenate([ends[0], middle, ends[1]])
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.stack(np.broadcast_arrays(0.0, np.cos(angle), np.sin(angle)), -1)
    points = profile[:, None, 1:] * ring + profile[:, None, :1] * [1.0, 0.0, 0.0]
    tips = np.array([[-half - radius, 0.0, 0.0], [half + radius, 0.0, 0.0]])
    rows = len(profile)
    here = np.arange(around)
    there = np.roll(here, -1)
    tip, last = rows * around, (rows - 1) * around
    fans = [
        np.stack([np.full(around, tip), here, there], 1),
        np.stack([np.full(around, tip + 1), last + there, last + here], 1),
    ]
    triangles = np.concatenate([_grid(rows, around, False, True), *fans])
    return _of(Finger(radius, half), np.concatenate([points.reshape(-1, 3), tips]), triangles)


def exact_tensors(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Return the exact tensors (n, 3, 3) in 1/mm at points of a surface."""
    return normals_and_tensors(surface, points)[1]


def _of(surface: Surface, points: np.ndarray, triangles: np.ndarray) -> Mesh:
    normals, _ = normals_and_tensors(surface, points)
    return mesh(points, triangles, normals, unit="mm")


def _grid(rows: int, columns: int, closed_rows: bool, closed_columns: bool) -> np.ndarray:
    """Return the triangles of a grid of vertices whose ends may be joined."""
    row, column = np.meshgrid(
        np.arange(rows - (not closed_rows)),
        np.arange(columns - (not closed_columns)),
        indexing="ij",
    )
    below, right = (row + 1) % rows, (column + 1) % columns
    a, b = row * columns + column, below * columns + column
    c, d = below * columns + right, row * columns + right
    return np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)


def _unit_icosphere(level: int) -> tuple[np.ndarray, np.ndarray]:
    if not 0 <= level <= 9:
        raise ValueError(f"level {level}: allowed are 0 to 9")
    golden = (1 + np.sqrt(5)) / 2
    corners = [[s, t * golden, 0.0] for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    points = np.array([np.roll(each, k) for k in range(3) for each in corners])
    points /= np.linalg.norm(points[0])
    # A triangle joins three vertices that are next neighbours, counterclockwise from outside.
    near = points @ points.T > 0.4
    np.fill_diagonal(near, False)
    faces = [
        (i, j, k)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    triangles = np.array(
        [f if np.linalg.det(points[list(f)]) > 0 else (f[0], f[2], f[1]) for f in faces]
    )
    for _ in range(level):
        points, triangles = _divided(points, triangles)
    return points, triangles


def _divided(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, place = np.unique(edges, axis=0, return_inverse=True)
    middle = points[unique].sum(1)
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    ab, bc, ca = place.reshape(-1, 3).T + len(points)
    a, b, c = triangles.T
    parts = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.concatenate([points, middle]), np.concatenate([np.stack(p, 1) for p in parts])
