"""The specular SGGX microflake distribution of Heitz et al. (2015) and its fibre-like case.

A distribution is a symmetric positive definite matrix S; its microflakes' normals are those of the
ellipsoid {x : xᵀS⁻¹x = 1}. The fibre of direction t and projected area α along t has
S = I − (1 − α²) t tᵀ.
"""

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from shading.types import Matrix, Scalar, Vector


def fiber_matrix(fiber: Vector, alpha: Scalar) -> Array:
    """Give S (3, 3) of a fibre of unit direction `fiber` and projected area `alpha` in (0, 1]."""
    fiber, alpha = jnp.asarray(fiber), jnp.asarray(alpha)
    return jnp.eye(3) - (1 - alpha) * (1 + alpha) * jnp.outer(fiber, fiber)


def fiber_root(fiber: Vector, alpha: Scalar) -> Array:
    """Give the symmetric root (3, 3) of `fiber_matrix`: I − t tᵀ + α t tᵀ, to full precision in α.

    S itself holds α² next to one, and is singular in float64 for α < 1e-8.
    """
    fiber = jnp.asarray(fiber)
    along = jnp.outer(fiber, fiber)
    return jnp.eye(3) - along + jnp.asarray(alpha) * along


def projected_area(matrix: Matrix, direction: Vector) -> Array:
    """Give σ(ω) = √(ωᵀSω), the microflakes' area per volume seen from the unit vector ω."""
    direction = jnp.asarray(direction)
    return jnp.sqrt(direction @ matrix @ direction)


def normal_distribution(matrix: Matrix, normal: Vector) -> Array:
    """Give D(h) = 1 / (π √|S| (hᵀS⁻¹h)²) for a unit vector h, per steradian."""
    normal, (x, y, z) = jnp.asarray(normal), jnp.asarray(matrix)
    # |S| S⁻¹ by cofactors: under `vmap` over normals a solver would factorise S for each.
    adjugate = jnp.stack([jnp.cross(y, z), jnp.cross(z, x), jnp.cross(x, y)])
    determinant = x @ adjugate[0]
    return determinant**1.5 / (jnp.pi * (normal @ adjugate @ normal) ** 2)


def fiber_projected_area(cos_t: Scalar, alpha: Scalar) -> Array:
    """Give the fibre's σ_F = √(1 − (ω·t)²(1 − α²)) from `cos_t` = ω·t."""
    alpha = jnp.asarray(alpha)
    return jnp.sqrt(1 - jnp.asarray(cos_t) ** 2 * (1 - alpha) * (1 + alpha))


def fiber_normal_distribution(cos_t: Scalar, alpha: Scalar) -> Array:
    """Give the fibre's D_F = α³ / (π ((h·t)²(1 − α²) + α²)²) from `cos_t` = h·t, per steradian."""
    alpha = jnp.asarray(alpha)
    return alpha**3 / (
        jnp.pi * (jnp.asarray(cos_t) ** 2 * (1 - alpha) * (1 + alpha) + alpha**2) ** 2
    )


def reflect(direction: Vector, normal: Vector) -> Array:
    """Mirror the unit vector `direction` about the unit vector `normal`: 2(ω·m)m − ω."""
    direction, normal = jnp.asarray(direction), jnp.asarray(normal)
    return 2 * (direction @ normal) * normal - direction


def sample_visible_normal(matrix: Matrix, light: Vector, sample: Float[Array, "2"]) -> Array:
    """Draw a microflake normal as seen from `light`: density D(m)⟨u·m⟩ / σ(u) per steradian.

    `sample` is uniform in [0, 1)².
    """
    return visible_normal(jnp.linalg.cholesky(jnp.asarray(matrix)), light, sample)


def visible_normal(root: Matrix, light: Vector, sample: Float[Array, "2"]) -> Array:
    """Do as `sample_visible_normal` does, for any `root` L (3, 3) of S = LLᵀ.

    With m ∝ Lp, the visible p are those of a unit sphere in orthographic projection along Lᵀu,
    so a uniform point of the disk gives m.
    """
    root = jnp.asarray(root)
    axis = root.T @ jnp.asarray(light)
    axis = axis / jnp.linalg.norm(axis)
    tangent, bitangent = _orthonormal(axis)
    radius, angle = jnp.sqrt(sample[0]), 2 * jnp.pi * sample[1]
    point = (
        radius * jnp.cos(angle) * tangent
        + radius * jnp.sin(angle) * bitangent
        + jnp.sqrt(1 - sample[0]) * axis
    )
    normal = root @ point
    return normal / jnp.linalg.norm(normal)


def _orthonormal(axis: Array) -> tuple[Array, Array]:
    """Complete the unit vector `axis` to an orthonormal frame (Duff et al. 2017)."""
    x, y, z = axis
    sign = jnp.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    b = x * y * a
    return (
        jnp.stack([1 + sign * x * x * a, sign * b, -sign * x]),
        jnp.stack([b, sign + y * y * a, -y]),
    )
