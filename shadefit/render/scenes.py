"""The scenes, a sphere and a cloth that is draped over a ball, and what a camera sees of them.

World axes: x to the right, y away from the camera, z up. Arrays have one row for each sample of a
square image, in the order of its rows from the top left.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

# A ray takes _STEPS steps to the cloth and halves the last one _HALVINGS times; a ray to the sun
# takes _SHADOW_STEPS steps.
_STEPS, _HALVINGS, _SHADOW_STEPS = 80, 12, 24
# The horizon around a point of the cloth is searched in _AZIMUTHS directions, in _HORIZON_STEPS
# steps each.
_AZIMUTHS, _HORIZON_STEPS = 8, 8
# The first row of an image and the one after the last; None stands for all rows.
Rows = tuple[int, int] | None


@dataclass(frozen=True)
class Hits:
    """The points that the n samples of an image see.

    * `seen` (n,): whether the sample sees the surface; otherwise it sees the backdrop.
    * `position` (n, 3), and `normal` (n, 3), a unit vector.
    * `comb` (n, 3): the unit tangent towards which fibres lean at azimuth 0.
    * `view` (n, 3): the unit vector to the camera.
    * `uv` (n, 2): coordinates in maps, in [0, 1).
    * `open_sky` (n,): the part of the sky's light that the surface itself does not block.
    """

    seen: np.ndarray
    position: np.ndarray
    normal: np.ndarray
    comb: np.ndarray
    view: np.ndarray
    uv: np.ndarray
    open_sky: np.ndarray


@dataclass(frozen=True)
class Scene:
    """A surface with a camera.

    * `hits(size, rows)`: the points that the samples see of an image of `size` × `size` samples;
      without `rows` all of them, otherwise those of the rows from `rows[0]` to below `rows[1]`.
    * `sunlit(position, sun)`: the visible part (n,) of the sun, 0 to 1, at points (n, 3). `sun`
      (3,) is the unit vector to the sun.
    """

    name: str
    hits: Callable[..., Hits]
    sunlit: Callable[[np.ndarray, np.ndarray], np.ndarray]


def camera(
    size: int, eye: tuple, target: tuple, width: float, rows: Rows = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the position (3,) of a perspective camera and its rays' unit directions (n, 3).

    The camera is at `eye`, looks at `target`, and z is up. `width` is the width of what it sees at
    the distance of `target`. There are n = size² rays, or size for each of the `rows`.
    """
    eye_, target_ = np.array(eye, float), np.array(target, float)
    ahead = (target_ - eye_) / np.linalg.norm(target_ - eye_)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    line = ((np.arange(size) + 0.5) / size - 0.5) * width / np.linalg.norm(target_ - eye_)
    x, y = np.meshgrid(line, -line[slice(*rows) if rows else slice(None)])
    rays = ahead + x[..., None] * right + y[..., None] * up
    rays = rays.reshape(-1, 3)
    return eye_, rays / np.linalg.norm(rays, axis=1, keepdims=True)


def _sphere_hits(size: int, rows: Rows = None) -> Hits:
    eye, rays = camera(size, (0, -6, 1.6), (0, 0, 0), 2.3, rows)
    along = rays @ eye
    discriminant = along**2 - (eye @ eye - 1)
    seen = discriminant > 0
    distance = -along - np.sqrt(np.where(seen, discriminant, 0.0))
    position = eye + distance[:, None] * rays
    normal = position / np.linalg.norm(position, axis=1, keepdims=True)
    around = np.arctan2(position[:, 0], -position[:, 1]) / (2 * np.pi) + 0.5
    uv = np.stack([around, np.arccos(np.clip(position[:, 2], -1, 1)) / np.pi], axis=1)
    return Hits(seen, position, normal, _comb(normal), -rays, uv, np.ones(len(rays)))


def cloth_height(x: Array, y: Array) -> Array:
    """Return the height z of the cloth at (x, y): folds, and a bump where the ball is."""
    r2 = (x + 0.15) ** 2 + (y - 0.4) ** 2
    ball = 0.55 * jnp.exp(-r2 / 0.36)
    across = x + 0.28 * jnp.sin(1.5 * y + 0.7) + 0.1 * jnp.sin(2.9 * y - x)
    along = y + 0.22 * jnp.sin(1.7 * x + 2.1)
    folds = 0.13 * jnp.sin(4.2 * across + 1.1 * along + 0.8) + 0.06 * jnp.sin(
        7.3 * across - 1.9 * along
    )
    crease = 0.028 * jnp.sin(10.3 * across + 2.3 * along + jnp.sin(3 * along))
    return ball + (1 - 0.9 * jnp.exp(-r2 / 0.4)) * (folds + crease)


def _cloth_hits(size: int, rows: Rows = None) -> Hits:
    eye, rays = camera(size, (0, -4.2, 4.4), (0, 0, 0.1), 2.9, rows)
    position = np.array(_march(_single(eye), _single(rays)), float)
    position[:, 2] = cloth_height(jnp.asarray(position[:, 0]), jnp.asarray(position[:, 1]))
    normal = np.asarray(_cloth_normal(jnp.asarray(position)))
    open_sky = np.asarray(_open_sky(_single(position), _single(normal)), float)
    uv = (position[:, :2] / 4 + 0.5) % 1
    return Hits(np.ones(len(rays), bool), position, normal, _comb(normal), -rays, uv, open_sky)


@jax.jit
def _cloth_normal(position: Array) -> Array:
    slope = jax.vmap(jax.grad(lambda xy: cloth_height(xy[0], xy[1])))(position[:, :2])
    normal = jnp.concatenate([-slope, jnp.ones((len(position), 1))], axis=1)
    return normal / jnp.linalg.norm(normal, axis=1, keepdims=True)


@jax.jit
def _march(eye: Array, rays: Array) -> Array:
    """Return the points (n, 3) where rays first meet the cloth.

    Equal steps bring a ray to the last point before the cloth; halved steps then refine it.
    """
    top, bottom = 1.0, -0.35
    near, far = (top - eye[2]) / rays[:, 2], (bottom - eye[2]) / rays[:, 2]
    step = (far - near) / _STEPS

    def above(distance):
        p = eye + distance[:, None] * rays
        return p[:, 2] > cloth_height(p[:, 0], p[:, 1])

    def advance(_, distance):
        return jnp.where(above(distance + step), distance + step, distance)

    def halve(i, distance):
        forward = distance + step * 0.5 ** (i + 1).astype(step.dtype)
        return jnp.where(above(forward), forward, distance)

    distance = jax.lax.fori_loop(0, _STEPS, advance, near)
    distance = jax.lax.fori_loop(0, _HALVINGS, halve, distance)
    return eye + distance[:, None] * rays


def _cloth_sunlit(position: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Return the part (n,) of the sun, some degrees wide, that the cloth does not cover."""
    return np.asarray(_visible_sun(_single(position), _single(sun)), float)


def _single(values: np.ndarray) -> Array:
    """Convert to float32, which is precise enough for rays over the cloth and twice as fast."""
    return jnp.asarray(values, jnp.float32)


@jax.jit
def _visible_sun(position: Array, sun: Array) -> Array:
    """Return a soft shadow (n,) from the least clearance over distance on the way to the sun."""

    def clearance(i, least):
        distance = 0.02 + 1.6 * ((i + 1).astype(position.dtype) / _SHADOW_STEPS) ** 1.5
        p = position + distance * sun
        room = (p[:, 2] - cloth_height(p[:, 0], p[:, 1])) / distance
        return jnp.minimum(least, room)

    room = jax.lax.fori_loop(0, _SHADOW_STEPS, clearance, jnp.ones_like(position[:, 0]))
    lit = jnp.clip(room / 0.12 + 0.5, 0, 1)
    return lit * lit * (3 - 2 * lit)


@jax.jit
def _open_sky(position: Array, normal: Array) -> Array:
    """Estimate the part (n,) of the sky's cosine-weighted light that the cloth does not block."""

    def hidden(k, total):
        azimuth = (k.astype(position.dtype) + 0.5) * (2 * jnp.pi / _AZIMUTHS)
        ahead = jnp.stack([jnp.cos(azimuth), jnp.sin(azimuth)])

        def rise(i, steepest):
            distance = 0.03 + 1.4 * ((i + 1).astype(position.dtype) / _HORIZON_STEPS) ** 2
            there = position[:, :2] + distance * ahead
            height = cloth_height(there[:, 0], there[:, 1]) - position[:, 2]
            return jnp.maximum(steepest, height / distance)

        # The horizon is at least the tangent plane; only what rises above it blocks light.
        plane = -(normal[:, :2] @ ahead) / normal[:, 2]
        slope = jax.lax.fori_loop(0, _HORIZON_STEPS, rise, plane)
        return total + jnp.sin(jnp.arctan(slope)) - jnp.sin(jnp.arctan(plane))

    total = jax.lax.fori_loop(0, _AZIMUTHS, hidden, jnp.zeros_like(position[:, 0]))
    return jnp.clip(1 - total / _AZIMUTHS, 0.05, 1)


def _comb(normal: np.ndarray) -> np.ndarray:
    """Return the x axis projected onto the tangent planes, as unit vectors (n, 3).

    The vector is shorter than one where the normal is almost the x axis.
    """
    across = np.array([1.0, 0.0, 0.0]) - normal[:, :1] * normal
    return across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-6)


SCENES = {
    "sphere": Scene("sphere", _sphere_hits, lambda position, _: np.ones(len(position))),
    "cloth": Scene("cloth", _cloth_hits, _cloth_sunlit),
}
