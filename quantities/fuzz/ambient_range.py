"""Whether an ambient model can give a negative radiance, or more than a light has.

A light of nine harmonics that is nowhere negative gets a radiance that is not negative, for every
such light, if and only if M0 ≥ 0 and the matrix M2/M0 − R Rᵀ has no negative eigenvalue. If M0 ≤ 1
too, no radiance is above the largest of the light. docs/ambient-light.md proves both.
"""

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from shading.harmonics import FIRST, FLAT, SECOND, ZONAL

Weights = Float[Array | np.ndarray, "n 9"]


def moments_of_weights(weights: Weights) -> tuple[Array, Array, Array]:
    """Return M0 (n,), R (n, 3) and M2/M0 (n, 3, 3) from weights (n, 9) of the nine harmonics."""
    weights = jnp.asarray(weights)
    total = weights[:, 0] / FLAT
    unit = weights / total[:, None]
    mean = jnp.stack([unit[:, 3], unit[:, 1], unit[:, 2]], axis=1) / FIRST
    zz = (unit[:, 6] / ZONAL + 1) / 3
    xy, yz, xz, gap = (unit[:, i] / SECOND for i in (4, 5, 7, 8))
    xx, yy = (1 - zz) / 2 + gap, (1 - zz) / 2 - gap
    square = jnp.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3)
    return total, mean, square


def least_variances(weights: Weights) -> Array:
    """Return the least eigenvalue (n,) of M2/M0 − R Rᵀ from weights (n, 9).

    It is the least variance of the direction of the light along any line.
    """
    _, mean, square = moments_of_weights(weights)
    return jnp.linalg.eigvalsh(square - mean[:, :, None] * mean[:, None, :])[:, 0]
