"""Tangent frames, and how a curvature tensor is carried from one tangent plane to another."""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.types import Vector

# A frame (2, 3): the tangent t and the bitangent b, orthogonal unit vectors.
Frame = Float[ArrayLike, "2 3"]
# A tensor (3,): (II_tt, II_tb, II_bb) in a frame, in 1/mm.
Tensor = Float[ArrayLike, "3"]


def tangent_frame(normal: Vector) -> Array:
    """Return the frame (2, 3) that is computed from a unit normal alone, with t × b = n.

    It is that of Duff et al. 2017 ("Building an orthonormal basis, revisited"). It jumps at
    n_z = 0; −0 counts as +0. A shader can compute the same frame again.
    """
    x, y, z = jnp.asarray(normal)
    side = jnp.where(z >= 0, 1.0, -1.0)
    a = -1 / (side + z)
    b = x * y * a
    tangent = jnp.stack([1 + side * x * x * a, side * b, -side * x])
    return jnp.stack([tangent, jnp.stack([b, side + y * y * a, -y])])


def rotated(vector: Vector, start: Vector, end: Vector) -> Array:
    """Return a vector (3,) rotated by the shortest arc that takes `start` to `end`.

    `start` and `end` are unit vectors. The axis of the rotation is the line that the planes
    orthogonal to them have in common. If they are opposite, the shortest arc is not unique and the
    result is −vector, for which a tensor is the same as for the vector.
    """
    vector, start, end = (jnp.asarray(each) for each in (vector, start, end))
    cosine = start @ end
    axis = jnp.cross(start, end)
    # Opposite vectors have axis 0, and so anything but zero will do as a divisor.
    along = axis * (axis @ vector) / jnp.maximum(1 + cosine, 1e-30)
    return cosine * vector + jnp.cross(axis, vector) + along


def expressed(tensor: Tensor, frame: Frame, other: Frame) -> Array:
    """Return a tensor (3,) of `frame` in an `other` frame of the same plane."""
    xx, xy, yy = jnp.asarray(tensor)
    matrix = jnp.stack([jnp.stack([xx, xy]), jnp.stack([xy, yy])])
    turn = jnp.asarray(other) @ jnp.asarray(frame).T
    found = turn @ matrix @ turn.T
    return jnp.stack([found[0, 0], found[0, 1], found[1, 1]])


def carried(tensor: Tensor, frame: Frame, other: Frame) -> Array:
    """Return a tensor (3,) of `frame` in an `other` frame whose plane may be another one.

    The other frame is first rotated into the plane of `frame` by the shortest arc between the
    normals t × b. This does not change mean and Gaussian curvature.
    """
    frame, other = jnp.asarray(frame), jnp.asarray(other)
    start, end = jnp.cross(*other), jnp.cross(*frame)
    within = jnp.stack([rotated(other[0], start, end), rotated(other[1], start, end)])
    return expressed(tensor, frame, within)
