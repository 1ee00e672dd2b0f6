"""A curvature tensor in four bytes: signed normalised integers of a stated range.

The four are (II_tt, II_tb, II_bb, mean curvature), as the talk has them. The fourth is redundant:
it is half the sum of the first and the third. A vertex format of four signed normalised bytes gives
a shader code/127, which `unpacked` multiplies with the range.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.curvature.frames import Tensor
from shading.curvature.from_light import mean
from shading.types import Scalar

# The largest curvature that is stored, in 1/mm: that of a sphere with a radius of 2 mm.
RANGE = 0.5
LARGEST_CODE = 127


def packed(tensor: Tensor, largest: Scalar = RANGE) -> Array:
    """Return the four codes (4,), whole numbers in [−127, 127], of a tensor in 1/mm.

    `largest` is the range: entries beyond ±`largest` are clamped to it. It must be positive.
    """
    xx, xy, yy = jnp.asarray(tensor)
    four = jnp.stack([xx, xy, yy, mean(tensor)])
    scaled = jnp.minimum(jnp.maximum(four / largest, -1.0), 1.0)
    return jnp.floor(scaled * LARGEST_CODE + 0.5)


def unpacked(codes: Float[ArrayLike, "4"], largest: Scalar = RANGE) -> Array:
    """Return (II_tt, II_tb, II_bb, mean curvature) of four codes. −128 counts as −127."""
    normalised = jnp.maximum(jnp.asarray(codes) / LARGEST_CODE, -1.0)
    return normalised * largest


def packing_error(largest: float = RANGE) -> float:
    """Return the largest error of one entry within the range, half a step, in 1/mm."""
    return largest / LARGEST_CODE / 2
