"""A GGX lobe about a mapped normal: its symmetric matrices, its distribution, and its masking.

In the frame M of the normal, the roughness is a symmetric matrix A (2, 2). Its eigenvalues are α_t²
and α_b², along the tangent and the bitangent. It is given by three numbers (A_xx, A_xy, A_yy),
called `roughness` here. The SGGX matrix of the lobe is S = M [A 0; 0 1] Mᵀ. No formula of this
module needs the eigenvectors.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.maps.frame import normal_frame
from shading.types import Matrix, Scalar, Vector

Roughness = Float[ArrayLike, "3"]


def roughness_matrix(along: Scalar, across: Scalar, angle: Scalar) -> Array:
    """Return (A_xx, A_xy, A_yy) (3,) of the widths α_t = `along` and α_b = `across`.

    `angle` is that of the tangent in the frame of the normal, in radians. Widths are positive.
    """
    cosine, sine = jnp.cos(angle), jnp.sin(angle)
    along, across = jnp.asarray(along) ** 2, jnp.asarray(across) ** 2
    return jnp.stack(
        [
            along * cosine**2 + across * sine**2,
            (along - across) * cosine * sine,
            along * sine**2 + across * cosine**2,
        ]
    )


def lobe_matrix(normal: Vector, roughness: Roughness) -> Array:
    """Return the SGGX matrix S (3, 3) of a lobe about the unit vector `normal`."""
    frame, (xx, xy, yy) = normal_frame(normal), jnp.asarray(roughness)
    t, b, n = frame.T
    mixed = jnp.outer(t, b)
    return xx * jnp.outer(t, t) + xy * (mixed + mixed.T) + yy * jnp.outer(b, b) + jnp.outer(n, n)


def lobe_ndf(half: Vector, roughness: Roughness) -> Array:
    """Return D(h) per steradian, for a unit vector h in the frame of the normal.

    D = P³/(π (A_yy hx² − 2 A_xy hx hy + A_xx hy² + P² hz²)²) with P = √(A_xx A_yy − A_xy²). It is 0
    for hz ≤ 0.
    """
    (x, y, z), (xx, xy, yy) = jnp.asarray(half), jnp.asarray(roughness)
    square = determinant(roughness)
    form = yy * x * x - 2 * xy * x * y + xx * y * y + square * z * z
    density = square * jnp.sqrt(square) / (jnp.pi * form * form)
    return jnp.where(z > 0, density, 0.0)


def lobe_projected_roughness(direction: Vector, roughness: Roughness) -> Array:
    """Return σ(w) = √(A_xx wx² + 2 A_xy wx wy + A_yy wy² + wz²), w in the frame of the normal.

    Smith's masking is G1(w) = 2wz/(wz + σ(w)); see `shading.microfacet.ggx`.
    """
    (x, y, z), (xx, xy, yy) = jnp.asarray(direction), jnp.asarray(roughness)
    return jnp.sqrt(xx * x * x + 2 * xy * x * y + yy * y * y + z * z)


def lobe_masking(direction: Vector, roughness: Roughness) -> Array:
    """Return Smith's G1(w) = 2wz/(wz + σ(w)) for wz ≥ 0, w in the frame of the normal."""
    cosine = jnp.asarray(direction)[2]
    return 2 * cosine / (cosine + lobe_projected_roughness(direction, roughness))


def lobe_brdf(view: Vector, light: Vector, roughness: Roughness) -> Array:
    """Return D(h) G2/(4μν) = D(h)/(2 (μσ(i) + νσ(o))) per steradian; G2 is height-correlated.

    The unit vectors o = `view` and i = `light` are in the frame of the normal. The value is 0
    unless both are above the surface.
    """
    o, i = jnp.asarray(view), jnp.asarray(light)
    above = (o[2] > 0) & (i[2] > 0)
    zenith = jnp.array([0.0, 0.0, 1.0])
    o, i = jnp.where(above, o, zenith), jnp.where(above, i, zenith)
    both = o + i
    half = both / jnp.sqrt(both @ both)
    across = o[2] * lobe_projected_roughness(i, roughness)
    across = across + i[2] * lobe_projected_roughness(o, roughness)
    return jnp.where(above, lobe_ndf(half, roughness) / (2 * across), 0.0)


def determinant(roughness: Roughness) -> Array:
    """Return |A| = A_xx A_yy − A_xy² = (α_t α_b)²."""
    xx, xy, yy = jnp.asarray(roughness)
    return xx * yy - xy * xy


def slope_moments(matrix: Matrix) -> tuple[Array, Array]:
    """Return the slopes μ (2,) and the matrix Â (2, 2) of a lobe from its SGGX matrix S.

    S/S₃₃ = [[Â + μμᵀ, μ], [μᵀ, 1]]. The slopes s = (hx, hy)/hz of the facets have the density
    1/(π √|Â| (1 + (s − μ)ᵀÂ⁻¹(s − μ))²), and μ are those of the normal. S₃₃ must be positive. The
    slopes have the sign of the direction: the normal is along (μ₁, μ₂, 1).
    """
    matrix = jnp.asarray(matrix)
    scaled = matrix / matrix[2, 2]
    mean = scaled[:2, 2]
    return mean, scaled[:2, :2] - jnp.outer(mean, mean)


def matrix_of_slopes(mean: Float[ArrayLike, "2"], spread: Float[ArrayLike, "2 2"]) -> Array:
    """Return [[Â + μμᵀ, μ], [μᵀ, 1]] (3, 3), the inverse of `slope_moments` up to a factor."""
    mean, spread = jnp.asarray(mean), jnp.asarray(spread)
    upper = jnp.concatenate([spread + jnp.outer(mean, mean), mean[:, None]], axis=1)
    return jnp.concatenate([upper, jnp.append(mean, 1.0)[None]])
