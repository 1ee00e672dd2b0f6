"""Surfaces with exact normals and curvature: ellipsoids, tori, cylinders and fingers, in mm.

A surface is where a function F is zero. Its normal is ∇F/|∇F|, and its tensor is the second
derivative of F in the tangent plane divided by |∇F|.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

Points = Float[np.ndarray, "n 3"]
Matrices = Float[np.ndarray, "n 3 3"]


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid with half axes (a, b, c) along x, y, z. With equal axes it is a sphere."""

    axes: tuple[float, float, float]

    def derivatives(self, points: Points) -> tuple[Points, Matrices]:
        """Return ∇F (n, 3) and the second derivatives (n, 3, 3) of F = ½ Σ (x/a)²."""
        inverse = 1 / np.square(self.axes)
        return points * inverse, np.broadcast_to(np.diag(inverse), (len(points), 3, 3))


@dataclass(frozen=True)
class Torus:
    """A torus about the z axis: `major` is the radius of the ring, `minor` that of the tube."""

    major: float
    minor: float

    def derivatives(self, points: Points) -> tuple[Points, Matrices]:
        """Return ∇F (n, 3) and the second derivatives (n, 3, 3) of F = ½ (ρ − R)² + ½ z²."""
        flat = points * [1.0, 1.0, 0.0]
        radius = np.linalg.norm(flat, axis=1)[:, None]
        out = flat / radius
        gradient = points - self.major * out
        outer = out[:, :, None] * out[:, None, :]
        plane = np.diag([1.0, 1.0, 0.0]) - outer
        return gradient, np.eye(3) - (self.major / radius)[:, :, None] * plane


@dataclass(frozen=True)
class Finger:
    """A cylinder along x with half a sphere at each end: a capsule.

    `half` is half the length of the cylinder. Curvature jumps where it meets the spheres; there it
    is that of the cylinder.
    """

    radius: float
    half: float

    def derivatives(self, points: Points) -> tuple[Points, Matrices]:
        """Return ∇F (n, 3) and the second derivatives (n, 3, 3) of half the squared distance."""
        beyond = np.abs(points[:, 0]) > self.half
        along = points[:, 0] - np.clip(points[:, 0], -self.half, self.half)
        gradient = np.column_stack([along, points[:, 1:]])
        seconds = np.tile(np.diag([0.0, 1.0, 1.0]), (len(points), 1, 1))
        seconds[beyond, 0, 0] = 1.0
        return gradient, seconds


Surface = Ellipsoid | Torus | Finger


def normals_and_tensors(surface: Surface, points: Points) -> tuple[Points, Matrices]:
    """Return unit normals (n, 3) and exact tensors (n, 3, 3) in 1/mm at points on a surface."""
    gradient, seconds = surface.derivatives(points)
    length = np.linalg.norm(gradient, axis=1)
    normals = gradient / length[:, None]
    plane = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    return normals, plane @ seconds @ plane / length[:, None, None]


def random_points(surface: Ellipsoid | Torus, count: int, seed: int) -> Points:
    """Return points (n, 3) that are uniform over the area of an ellipsoid or a torus."""
    random = np.random.default_rng(seed)
    kept: list[np.ndarray] = []
    while sum(map(len, kept)) < count:
        if isinstance(surface, Torus):
            around, tube = random.uniform(-np.pi, np.pi, (2, 2 * count))
            density = (surface.major + surface.minor * np.cos(tube)) / (
                surface.major + surface.minor
            )
            points = torus_points(surface, around, tube)
        else:
            directions = random.normal(size=(2 * count, 3))
            directions /= np.linalg.norm(directions, axis=1)[:, None]
            # The area of the sphere is stretched by det A |A⁻¹ s|.
            density = min(surface.axes) * np.linalg.norm(directions / surface.axes, axis=1)
            points = directions * surface.axes
        kept.append(points[random.random(2 * count) < density])
    return np.concatenate(kept)[:count]


def torus_points(surface: Torus, around: np.ndarray, tube: np.ndarray) -> Points:
    """Return points (n, 3) of a torus at angles around its axis and around its tube, in radians."""
    out = surface.major + surface.minor * np.cos(tube)
    return np.stack([out * np.cos(around), out * np.sin(around), surface.minor * np.sin(tube)], -1)
