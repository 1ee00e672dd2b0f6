"""The frame of a mapped normal: the rotation by the shortest arc from k = (0, 0, 1) to it."""

import jax.numpy as jnp
from jax import Array

from shading.types import Vector


def normal_frame(normal: Vector) -> Array:
    """Return the rotation M (3, 3) with M k = n along the shortest arc, for a unit vector n ≠ −k.

    The columns are the tangent, the bitangent and n, in the frame of the surface. The formula is
    that of Patry (2020). Its elements grow without limit as n approaches −k.
    """
    x, y, z = jnp.asarray(normal)
    over = 1 / (1 + z)
    cross = -x * y * over
    return jnp.stack(
        [
            jnp.stack([z + y * y * over, cross, x]),
            jnp.stack([cross, z + x * x * over, y]),
            jnp.stack([-x, -y, z]),
        ]
    )


def reoriented_normal(base: Vector, detail: Vector) -> Array:
    """Return the unit vector M_b d: the detail's normal d, carried by the frame of the base b.

    This is reoriented normal mapping (Barré-Brisebois and Hill 2012) of unit vectors.
    """
    return normal_frame(base) @ jnp.asarray(detail)
