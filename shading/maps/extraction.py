"""From an SGGX matrix back to a lobe: its normal, its roughness, its widths and its tangent.

All derivatives are finite, also for equal widths, where eigenvectors have none: the normal does not
depend on the other two eigenvectors, and the widths get a safe root.
"""

import jax
import jax.numpy as jnp
from jax import Array

from shading.maps.frame import normal_frame
from shading.maps.lobe import Roughness, determinant
from shading.types import Matrix

# A wider lobe than this has no meaning as a surface: α = 1 is the widest GGX in use.
LARGEST = 1.0


@jax.custom_jvp
def lobe_normal(matrix: Matrix) -> Array:
    """Return the unit eigenvector (3,) of S that is the normal of the lobe, with a positive z.

    S₃₃ = Σ λ z² over the eigenvalues λ and the z of the eigenvectors: the normal is the one with
    the largest part. It belongs to the largest eigenvalue unless the mean square of slopes exceeds
    about one: then the largest is that of a direction within the surface.
    """
    values, vectors = jnp.linalg.eigh(jnp.asarray(matrix))
    nearest = vectors[:, jnp.argmax(values * vectors[2] ** 2)]
    return jnp.where(nearest[2] < 0, -nearest, nearest)


@lobe_normal.defjvp
def _lobe_normal_jvp(primals, tangents):
    (matrix,), (change,) = primals, tangents
    normal = lobe_normal(matrix)
    value = normal @ matrix @ normal
    # The change is at right angles to n, and solves (λ − S) dn = (1 − n nᵀ) dS n there. Only the
    # distances of λ from the other eigenvalues matter, not their distance from each other.
    outer = jnp.outer(normal, normal)
    system = value * jnp.eye(3) - matrix + outer
    right = change @ normal
    right = right - (normal @ right) * normal
    return normal, jnp.linalg.solve(system, right)


def lobe_of_matrix(matrix: Matrix) -> tuple[Array, Array]:
    """Return the normal (3,) and the roughness (A_xx, A_xy, A_yy) (3,) of an SGGX matrix.

    The matrix may have any positive factor. Widths are limited to 1.
    """
    matrix = jnp.asarray(matrix)
    normal = lobe_normal(matrix)
    frame = normal_frame(normal)
    local = frame.T @ matrix @ frame
    scaled = local / local[2, 2]
    return normal, limited(jnp.stack([scaled[0, 0], scaled[0, 1], scaled[1, 1]]))


def limited(roughness: Roughness, largest: float = LARGEST) -> Array:
    """Return the roughness (3,) with both widths at most `largest`, and the same axes."""
    xx, xy, yy = jnp.asarray(roughness)
    along, across = squared_widths(roughness)
    new_along, new_across = jnp.minimum(along, largest**2), jnp.minimum(across, largest**2)
    ratio = _ratio(new_along - new_across, along - across)
    middle, half = (new_along + new_across) / 2, ratio * (xx - yy) / 2
    return jnp.stack([middle + half, ratio * xy, middle - half])


def squared_widths(roughness: Roughness) -> tuple[Array, Array]:
    """Return α_t² ≥ α_b², the eigenvalues of the roughness.

    α_b² is |A|/α_t², which keeps its digits. Where both are equal, derivatives are those of their
    mean.
    """
    xx, _, yy = jnp.asarray(roughness)
    along = (xx + yy) / 2 + _half_difference(roughness)
    return along, determinant(roughness) / along


def tangent(roughness: Roughness) -> Array:
    """Return the unit vector (2,) of α_t in the frame of the normal, with x ≥ 0.

    It is (1, 0) for equal widths.
    """
    xx, xy, yy = jnp.asarray(roughness)
    half, difference = _half_difference(roughness), (xx - yy) / 2
    round_lobe = half == 0
    safe = jnp.where(round_lobe, 1.0, half)
    # cos 2φ and sin 2φ; the half angle is taken from the larger of cos φ and sin φ.
    double = jnp.where(round_lobe, 1.0, difference / safe)
    sine = jnp.where(round_lobe, 0.0, xy / safe)
    near_x = double >= 0
    first = jnp.sqrt((1 + jnp.abs(double)) / 2)
    second = sine / (2 * first)
    x, y = jnp.where(near_x, first, jnp.abs(second)), jnp.where(near_x, second, first)
    return jnp.stack([x, jnp.where(~near_x & (sine < 0), -y, y)])


def _half_difference(roughness: Roughness) -> Array:
    """Return (α_t² − α_b²)/2 = √(((A_xx − A_yy)/2)² + A_xy²), with the derivative 0 at 0."""
    xx, xy, yy = jnp.asarray(roughness)
    square = ((xx - yy) / 2) ** 2 + xy * xy
    positive = square > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, square, 1.0)), 0.0)


def _ratio(above: Array, below: Array) -> Array:
    """Return above/below, and 1 for 0/0."""
    some = below > 0
    return jnp.where(some, above / jnp.where(some, below, 1.0), 1.0)
