"""Diffused light on surfaces by brute force: what skin fits with one curvature are judged by.

The light at a point is the mean of max(0, n·l) over the whole surface, weighted by Gaussians of the
straight distance, without shadows, as on ring and sphere. The surface is mapped so that the point
is the origin of the map, and panels of Gauss–Legendre nodes shrink towards it, down to the
narrowest Gaussian. An ellipsoid is mapped by the polar coordinates of the sphere that it is
stretched from, a torus by its two angles, and a finger by its meridian and the angle around it. The
capsule is mapped in three smooth pieces.
"""

import itertools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from integrals.rules.interval import gauss_legendre
from shadefit.curvature.gaussian_sums import in_plane
from shadefit.curvature.smoothing import convex_tensors
from shadefit.curvature.surfaces import (
    Ellipsoid,
    Finger,
    RoundedFinger,
    Surface,
    Torus,
    around_axis,
    normals_and_tensors,
    torus_points,
)
from shading.skin.profiles import GaussianProfile

PANELS, NODES, AROUND = 12, 8, 384


@dataclass(frozen=True)
class Patch:
    """A whole surface seen from one point: nodes, their normals and their areas in mm²."""

    points: Float[np.ndarray, "n 3"]
    normals: Float[np.ndarray, "n 3"]
    areas: Float[np.ndarray, " n"]


def patch(surface: Surface, point: np.ndarray, nodes: int = NODES) -> Patch:
    """Return the nodes of a surface that are graded towards a point (3,) on it, in mm.

    `nodes` are those of one of the panels; the others grow in proportion.
    """
    around = AROUND * nodes // NODES
    if isinstance(surface, Torus):
        return _torus_patch(surface, point, nodes)
    if isinstance(surface, Finger | RoundedFinger):
        return _finger_patch(surface, point, nodes)
    return _ellipsoid_patch(surface, point, nodes, around)


def diffused(
    seen: Patch, point: np.ndarray, light: np.ndarray, profile: GaussianProfile
) -> Float[np.ndarray, " c"]:
    """Return the diffused light of each channel at a `point` (3,), in mm.

    `light` (3,) is a unit vector to the light. A plane shows its cosine with the normal.
    """
    distance2 = np.sum((seen.points - point) ** 2, axis=1)
    variances = np.array(profile.variances)[:, None]
    falloff = np.exp(-distance2 / (2 * variances)) / (2 * np.pi * variances) * seen.areas
    lit = np.maximum(seen.normals @ light, 0.0)
    weights = np.array(profile.weights)
    return (weights @ (falloff @ lit)) / (weights @ falloff.sum(axis=1))


def blurred(
    surface: Surface,
    seen: Patch,
    point: np.ndarray,
    frame: np.ndarray,
    width: float,
    convex: bool = False,
) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 2"]]:
    """Return the tensor (3,) and the drift (2,) at a point, blurred by a Gaussian.

    `width` is its σ in mm. Tensors are carried by the shortest rotation, and do not count if
    normals are more than 90° apart, as in `smoothing`. With `convex`, their eigenvalues below zero
    become zero first. The drift is the part of the mean normal along the surface, divided by σ².
    Both are in `frame` (2, 3).
    """
    distance2 = np.sum((seen.points - point) ** 2, axis=1)
    normal = np.cross(*frame)
    near = (distance2 < (4 * width) ** 2) & (seen.normals @ normal > 0)
    places, normals = seen.points[near], seen.normals[near]
    weight = np.exp(-distance2[near] / (2 * width**2)) * seen.areas[near]
    weight /= weight.sum()
    _, matrices = normals_and_tensors(surface, places)
    frames = np.broadcast_to(frame, (len(places), 2, 3))
    tensors = in_plane(matrices, normals, frames, np.broadcast_to(normal, places.shape))
    if convex:
        tensors = convex_tensors(tensors)
    return weight @ tensors, frame @ (weight @ normals) / width**2


def _graded(nodes: int, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights on [0, end] in panels of which each is twice as long as the last."""
    edges = np.concatenate([[0.0], end * 2.0 ** -np.arange(PANELS - 1.0, -1.0, -1.0)])
    parts = [gauss_legendre(nodes, a, b) for a, b in itertools.pairwise(edges)]
    x, w = (np.concatenate([np.asarray(part[k]) for part in parts]) for k in range(2))
    return x, w


def _ellipsoid_patch(surface: Ellipsoid, point: np.ndarray, nodes: int, around: int) -> Patch:
    axes = np.array(surface.axes)
    pole = point / axes
    pole = pole / np.linalg.norm(pole)
    # The tangents are axes of the ellipse that a small ball cuts out of the sphere.
    plane = np.linalg.svd(pole[None, :])[2][1:]
    values, vectors = np.linalg.eigh((plane * axes**2) @ plane.T)
    first, second = vectors.T @ plane
    angle, weight = _graded(nodes, np.pi)
    # Azimuths are even in the metric of the ellipsoid at the point, where it is stretched most.
    turn = 2 * np.pi * (np.arange(around) + 0.5) / around
    wide, narrow = np.sqrt(values[1]), np.sqrt(values[0])
    x, y = np.cos(turn) / narrow, np.sin(turn) / wide
    length2 = x * x + y * y
    step = 2 * np.pi / around / (narrow * wide * length2)
    across = (x[:, None] * first + y[:, None] * second) / np.sqrt(length2)[:, None]
    sphere = (np.cos(angle)[:, None, None] * pole + np.sin(angle)[:, None, None] * across).reshape(
        -1, 3
    )
    solid = ((np.sin(angle) * weight)[:, None] * step).ravel()
    stretch = np.prod(axes) * np.linalg.norm(sphere / axes, axis=1)
    points = sphere * axes
    return Patch(points, normals_and_tensors(surface, points)[0], solid * stretch)


def _torus_patch(surface: Torus, point: np.ndarray, nodes: int) -> Patch:
    radius = np.hypot(point[0], point[1])
    around, tube = np.arctan2(point[1], point[0]), np.arctan2(point[2], radius - surface.major)
    half, weight = _graded(nodes, np.pi)
    offset, step = np.concatenate([-half[::-1], half]), np.concatenate([weight[::-1], weight])
    u, v = np.meshgrid(around + offset, tube + offset, indexing="ij")
    points = torus_points(surface, u.ravel(), v.ravel())
    out = surface.major + surface.minor * np.cos(v.ravel())
    areas = (step[:, None] * step).ravel() * out * surface.minor
    return Patch(points, normals_and_tensors(surface, points)[0], areas)


def _finger_patch(surface: Finger | RoundedFinger, point: np.ndarray, nodes: int) -> Patch:
    distance, azimuth = float(np.hypot(point[1], point[2])), np.arctan2(point[2], point[1])
    half, weight = _graded(nodes, np.pi)
    turn = azimuth + np.concatenate([-half[::-1], half])
    step = np.concatenate([weight[::-1], weight])
    parts, areas = [], []
    for piece in surface.pieces():
        nearest = piece.nearest(float(point[0]), distance)
        before, weight_before = _graded(nodes, nearest - piece.start)
        after, weight_after = _graded(nodes, piece.end - nearest)
        along = nearest + np.concatenate([-before[::-1], after])
        x, ring, stretch = piece.at(along)
        area = np.concatenate([weight_before[::-1], weight_after]) * ring * stretch
        parts.append(around_axis(x[:, None], ring[:, None], turn).reshape(-1, 3))
        areas.append((area[:, None] * step).ravel())
    points = np.concatenate(parts)
    return Patch(points, normals_and_tensors(surface, points)[0], np.concatenate(areas))
