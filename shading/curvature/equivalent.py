"""The lit cylinder that stands for a curved surface in a light, and the drift of its normal.

Diffusion is the mean of max(0, n·l) over a patch. Where all of the patch is lit, only the mean of
the normals counts. For a Gaussian of the variance v it is, to first order in v,

    n (1 − ½ v ‖II‖²) + v g,   g = ½ ∇(II_tt + II_bb)

with the gradient along the surface. g is the drift. At the terminator, only the slope |II l_t| of
n·l counts. A cylinder of the curvature κ, in light with the part s across its axis, has κ² and
κ √(s² − c²) in place of ‖II‖² and |II l_t|, where c = n·l. So κ = ‖II‖ and
s² = c² + |II l_t|²/‖II‖² are the cylinder that agrees with the surface in both, and its light is
s D(c/s, κ), where D is that of a cylinder lit across its axis. A cylinder stands for itself,
whatever its light. κ_eff of `from_light` is s κ.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.curvature.frames import Tensor
from shading.curvature.from_light import Projected
from shading.types import Scalar

Drift = Float[ArrayLike, "2"]
# Tensors below this curvature in 1/mm are flat: their radius is more than 50 metres. In half
# precision its reciprocal is finite.
_LEAST = 2e-5


class EquivalentCylinder(NamedTuple):
    """The arguments of a fit of D, and the `scale` ≥ 0 that its value is multiplied by.

    `curvature` is in 1/mm. `cosine` is in [−1, 1]. On a flat surface all is as without diffusion.
    """

    cosine: Array
    curvature: Array
    scale: Array


def equivalent_cylinder(tensor: Tensor, light: Projected, cosine: Scalar) -> EquivalentCylinder:
    """Return the cylinder with the light of a surface: it is scale · D(cosine, curvature).

    `cosine` is n·l, not clamped at 0, or that of `drifted`. `light` is (l·t, l·b), not normalised.
    For a unit light without a drift the scale is at most 1. A drift that makes |n·l| larger may
    take it, and so the light, above 1. All values and gradients are finite.
    """
    entries, c = jnp.asarray(tensor), jnp.asarray(cosine)
    x, y = jnp.asarray(light)
    # Squares of small curvatures would underflow in half precision, those of ratios do not.
    largest = jnp.maximum(
        jnp.maximum(jnp.abs(entries[0]), jnp.abs(entries[1])), jnp.abs(entries[2])
    )
    flat = largest <= _LEAST
    unit = 1 / jnp.where(flat, 1.0, largest)
    xx, xy, yy = (jnp.where(flat, one, entries[k] * unit) for k, one in enumerate((1.0, 0.0, 1.0)))
    norm2 = xx * xx + 2 * xy * xy + yy * yy
    along, across = xx * x + xy * y, xy * x + yy * y
    scale2 = c * c + (along * along + across * across) / norm2
    dark = scale2 <= 0
    scale = jnp.where(dark, 0.0, jnp.sqrt(jnp.where(dark, 1.0, scale2)))
    ratio = jnp.minimum(jnp.maximum(c / jnp.where(dark, 1.0, scale), -1.0), 1.0)
    return EquivalentCylinder(ratio, jnp.where(flat, 0.0, largest * jnp.sqrt(norm2)), scale)


def drifted(cosine: Scalar, drift: Drift, light: Projected, variance: Scalar) -> Array:
    """Return n·l with the drift of the blurred normal, for a profile's mean variance in mm².

    `drift` is in the frame of `light`, in 1/mm². `GaussianProfile.mean_variances` has those of
    skin. The light is brighter towards where curvature increases.
    """
    x, y = jnp.asarray(light)
    gx, gy = jnp.asarray(drift)
    return jnp.asarray(cosine) + jnp.asarray(variance) * (gx * x + gy * y)
