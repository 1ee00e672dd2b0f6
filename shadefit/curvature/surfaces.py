"""Surfaces with exact normals and curvature: ellipsoids, tori and two kinds of fingers, in mm.

A surface is where a function F is zero. Its normal is ∇F/|∇F|, and its tensor is the second
derivative of F in the tangent plane divided by |∇F|.
"""

from collections.abc import Callable
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
class Piece:
    """A smooth piece of a finger, between `start` and `end` of a parameter u.

    * `at`: maps u (n,) to (3, n): the place x, the distance ρ from the axis, and the length of the
      derivative of (x, ρ).
    * `nearest`: maps x and ρ of a point on the finger to the u that is nearest to it or near that.
    """

    start: float
    end: float
    at: Callable[[np.ndarray], np.ndarray]
    nearest: Callable[[float, float], float]


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

    def pieces(self) -> tuple[Piece, ...]:
        """Return the cylinder, with u = x, and the two caps, with u the angle from the seam."""

        def straight(u):
            return np.stack([u, np.full_like(u, self.radius), np.ones_like(u)])

        def cap(side: float) -> Piece:
            def at(u):
                x, distance = self.half + self.radius * np.sin(u), self.radius * np.cos(u)
                return np.stack([side * x, distance, np.full_like(u, self.radius)])

            def nearest(x: float, distance: float) -> float:
                return float(np.arctan2(max(side * x - self.half, 0.0), distance))

            return Piece(0.0, np.pi / 2, at, nearest)

        middle = Piece(
            -self.half, self.half, straight, lambda x, _: float(np.clip(x, -self.half, self.half))
        )
        return middle, cap(1.0), cap(-1.0)


@dataclass(frozen=True)
class RoundedFinger:
    """A finger along x whose curvature does not jump: (x/a)⁴ + (ρ/r)² = 1 with ρ² = y² + z².

    `radius` is r, that of the middle, and `half` is a, half the length.
    """

    radius: float
    half: float

    def derivatives(self, points: Points) -> tuple[Points, Matrices]:
        """Return ∇F (n, 3) and the second derivatives (n, 3, 3) of F = ½ ((x/a)⁴ + (ρ/r)²)."""
        inverse, x = 1 / self.radius**2, points[:, 0]
        gradient = np.column_stack([2 * x**3 / self.half**4, points[:, 1:] * inverse])
        seconds = np.tile(np.diag([0.0, inverse, inverse]), (len(points), 1, 1))
        seconds[:, 0, 0] = 6 * x**2 / self.half**4
        return gradient, seconds

    def pieces(self) -> tuple[Piece]:
        """Return the whole: x = a sin u and ρ = r cos u √(1 + sin² u)."""

        def at(u):
            s, c = np.sin(u), np.cos(u)
            root = np.sqrt(1 + s * s)
            # dρ/du = −2 r sin³ u/√(1 + sin² u)
            slope = np.hypot(self.half * c, 2 * self.radius * s**3 / root)
            return np.stack([self.half * s, self.radius * c * root, slope])

        def nearest(x: float, _: float) -> float:
            return float(np.arcsin(np.clip(x / self.half, -1.0, 1.0)))

        return (Piece(-np.pi / 2, np.pi / 2, at, nearest),)


Surface = Ellipsoid | Torus | Finger | RoundedFinger


def normals_and_tensors(surface: Surface, points: Points) -> tuple[Points, Matrices]:
    """Return unit normals (n, 3) and exact tensors (n, 3, 3) in 1/mm at points on a surface."""
    gradient, seconds = surface.derivatives(points)
    length = np.linalg.norm(gradient, axis=1)
    normals = gradient / length[:, None]
    plane = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    return normals, plane @ seconds @ plane / length[:, None, None]


def random_points(surface: Surface, count: int, seed: int) -> Points:
    """Return points (n, 3) that are uniform over the area of a surface."""
    random = np.random.default_rng(seed)
    kept: list[np.ndarray] = []
    while sum(map(len, kept)) < count:
        if isinstance(surface, Torus):
            around, tube = random.uniform(-np.pi, np.pi, (2, 2 * count))
            density = (surface.major + surface.minor * np.cos(tube)) / (
                surface.major + surface.minor
            )
            points = torus_points(surface, around, tube)
        elif isinstance(surface, Ellipsoid):
            directions = random.normal(size=(2 * count, 3))
            directions /= np.linalg.norm(directions, axis=1)[:, None]
            # The area of the sphere is stretched by det A |A⁻¹ s|.
            density = min(surface.axes) * np.linalg.norm(directions / surface.axes, axis=1)
            points = directions * surface.axes
        else:
            points, density = _finger_points(surface, random.random((2, 2 * count)))
        kept.append(points[random.random(2 * count) < density])
    return np.concatenate(kept)[:count]


def _finger_points(
    surface: Finger | RoundedFinger, chance: np.ndarray
) -> tuple[Points, np.ndarray]:
    """Return points of a finger for uniform numbers (2, n), and their density, at most 1."""
    pieces = surface.pieces()
    ends = np.cumsum([0.0, *(piece.end - piece.start for piece in pieces)])
    along, turn = chance[0] * ends[-1], 2 * np.pi * chance[1]
    whole = np.zeros((3, len(along)))
    for piece, low, high in zip(pieces, ends[:-1], ends[1:], strict=True):
        own = (along >= low) & (along < high)
        whole[:, own] = piece.at(piece.start + along[own] - low)
    x, distance, stretch = whole
    area = distance * stretch
    return around_axis(x, distance, turn), area / area.max()


def around_axis(x: np.ndarray, distance: np.ndarray, turn: np.ndarray) -> Float[np.ndarray, "*n 3"]:
    """Return points (…, 3) at x, at a distance from the x axis, turned about it in radians."""
    rows = np.broadcast_arrays(x, distance * np.cos(turn), distance * np.sin(turn))
    return np.stack(rows, axis=-1)


def torus_points(surface: Torus, around: np.ndarray, tube: np.ndarray) -> Points:
    """Return points (n, 3) of a torus at angles around its axis and around its tube, in radians."""
    out = surface.major + surface.minor * np.cos(tube)
    return np.stack([out * np.cos(around), out * np.sin(around), surface.minor * np.sin(tube)], -1)
