"""One curvature from a tensor and a light: several ways, all of a tensor (xx, xy, yy) in 1/mm.

`light` is (l·t, l·b): a unit vector projected to the tangent plane and not normalised, as
`projected_light` returns it. A fit of diffusion takes the absolute value of the curvature.

* `along_light`: lᵀ II l/|l_t|², the curvature of the surface along the light (the talk's text).
* `published`: lᵀ II l, not normalised (the talk's shader).
* `mean`: half the trace. It does not depend on the light.
* `bending_along_light`: |II l_t|/|l_t|, how fast the normal turns along the light.
* `effective`: κ_eff, by which n·l is spread over a blurred patch. It is the most exact of them.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.curvature.frames import Frame, Tensor
from shading.types import Vector

Projected = Float[ArrayLike, "2"]
# Below this squared length the direction of a projected light is not defined.
_LEAST_SQUARE = 1e-30


def projected_light(frame: Frame, light: Vector) -> Array:
    """Return (l·t, l·b) of a unit vector to the light."""
    return jnp.asarray(frame) @ jnp.asarray(light)


def published(tensor: Tensor, light: Projected) -> Array:
    """Return lᵀ II l, not normalised, which is the `CurvatureFromLight` of the talk."""
    xx, xy, yy = jnp.asarray(tensor)
    x, y = jnp.asarray(light)
    return xx * (x * x) + 2 * xy * x * y + yy * (y * y)


def along_light(tensor: Tensor, light: Projected) -> Array:
    """Return the normal curvature lᵀ II l/|l_t|² along the light; the mean for l_t = 0."""
    square, known = _square(light)
    return jnp.where(known, published(tensor, light) / square, mean(tensor))


def mean(tensor: Tensor) -> Array:
    """Return the mean curvature, half the trace."""
    xx, _, yy = jnp.asarray(tensor)
    return (xx + yy) / 2


def bending_along_light(tensor: Tensor, light: Projected) -> Array:
    """Return |II l_t|/|l_t|: how fast the normal turns along the light.

    For l_t = 0 it is the root mean square over all directions.
    """
    square, known = _square(light)
    ratio = jnp.where(known, _bent2(tensor, light) / square, _norm2(tensor) / 2)
    return _root(ratio)


def effective(tensor: Tensor, light: Projected) -> Array:
    """Return κ_eff = √(|II l_t|² + (n·l)² ‖II‖²) ≥ 0, with the Frobenius norm ‖II‖.

    Over a patch of a surface, n·l changes by −xᵀ II l_t to first and by −½ (n·l) |II x|² to second
    order in the place x. κ_eff combines the spreads of both. On a cylinder it does not depend on
    the part of the light that is along the axis, but in so far as that part is missing from l_⊥.
    """
    x, y = jnp.asarray(light)
    # (n·l)² of a unit vector; rounding may take it below zero.
    height2 = jnp.maximum(1 - (x * x + y * y), 0.0)
    return _root(_bent2(tensor, light) + height2 * _norm2(tensor))


def convex_part(tensor: Tensor) -> Array:
    """Return the tensor (3,) with its eigenvalues clamped at zero from below, so without concavity.

    All gradients are finite. At equal eigenvalues the derivative is that of the clamped mean.
    """
    xx, xy, yy = jnp.asarray(tensor)
    middle, half = (xx + yy) / 2, (xx - yy) / 2
    radius2 = half * half + xy * xy
    radius = _root(radius2)
    upper, lower = jnp.maximum(middle + radius, 0.0), jnp.maximum(middle - radius, 0.0)
    flat = radius2 <= 0
    ratio = (upper - lower) / (2 * jnp.where(flat, 1.0, radius))
    ratio = jnp.where(flat, jnp.where(middle > 0, 1.0, 0.0), ratio)
    clamped = (upper + lower) / 2
    return jnp.stack([clamped + ratio * half, ratio * xy, clamped - ratio * half])


def _bent2(tensor: Tensor, light: Projected) -> Array:
    xx, xy, yy = jnp.asarray(tensor)
    x, y = jnp.asarray(light)
    along, across = xx * x + xy * y, xy * x + yy * y
    return along * along + across * across


def _norm2(tensor: Tensor) -> Array:
    xx, xy, yy = jnp.asarray(tensor)
    return xx * xx + 2 * xy * xy + yy * yy


def _square(light: Projected) -> tuple[Array, Array]:
    """Return |l_t|², or 1 if it is too small to divide by, and whether it is not."""
    x, y = jnp.asarray(light)
    square = x * x + y * y
    known = square > _LEAST_SQUARE
    return jnp.where(known, square, 1.0), known


def _root(square: Array) -> Array:
    """Return a square root whose gradient is finite: it is zero at zero."""
    positive = square > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, square, 1.0)), 0.0)
