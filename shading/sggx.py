"""The SGGX microflake distribution of Heitz et al. (2015) with specular flakes.

A symmetric positive definite matrix S (3, 3) describes the distribution. The normals of the
microflakes are distributed like the normals of the ellipsoid {x : xᵀSx = 1}.

The functions named `fiber_…` are for the special case of a fibre. A fibre with unit direction t and
projected area α along t has S = I − (1 − α²) t tᵀ.
"""

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from shading.types import Matrix, Scalar, Vector


def fiber_matrix(fiber: Vector, alpha: Scalar) -> Array:
    """Return S (3, 3) of a fibre of unit direction `fiber` and projected area `alpha` in (0, 1]."""
    fiber, alpha = jnp.asarray(fiber), jnp.asarray(alpha)
    return jnp.eye(3) - (1 - alpha) * (1 + alpha) * jnp.outer(fiber, fiber)


def fiber_root(fiber: Vector, alpha: Scalar) -> Array:
    """Return the symmetric square root (3, 3) of `fiber_matrix`: I − t tᵀ + α t tᵀ.

    The root keeps α to full precision. S itself adds α² to numbers of the order of one, and it is
    singular in float64 for α < 1e-8.
    """
    fiber = jnp.asarray(fiber)
    along = jnp.outer(fiber, fiber)
    return jnp.eye(3) - along + jnp.asarray(alpha) * along


def projected_area(matrix: Matrix, direction: Vector) -> Array:
    """Return σ(ω) = √(ωᵀSω), the area of the microflakes as seen from the unit vector ω."""
    direction = jnp.asarray(direction)
    return jnp.sqrt(direction @ matrix @ direction)


def normal_distribution(matrix: Matrix, normal: Vector) -> Array:
    """Return the density of normals D(h) = 1 / (π √|S| (hᵀS⁻¹h)²), per steradian.

    `normal` h is a unit vector, and |S| is the determinant of S.
    """
    normal, (x, y, z) = jnp.asarray(normal), jnp.asarray(matrix)
    # Cofactors give |S| S⁻¹. A linear solver under `vmap` would factorise S once for each normal.
    adjugate = jnp.stack([jnp.cross(y, z), jnp.cross(z, x), jnp.cross(x, y)])
    determinant = x @ adjugate[0]
    return determinant**1.5 / (jnp.pi * (normal @ adjugate @ normal) ** 2)


def fiber_projected_area(cos_t: Scalar, alpha: Scalar) -> Array:
    """Return the projected area of a fibre, σ_F = √(1 − (ω·t)²(1 − α²)), from `cos_t` = ω·t."""
    alpha = jnp.asarray(alpha)
    return jnp.sqrt(1 - jnp.asarray(cos_t) ** 2 * (1 - alpha) * (1 + alpha))


def fiber_normal_distribution(cos_t: Scalar, alpha: Scalar) -> Array:
    """Return the density of a fibre's normals, per steradian, from `cos_t` = h·t.

    D_F = α³ / (π ((h·t)²(1 − α²) + α²)²).
    """
    alpha = jnp.asarray(alpha)
    return alpha**3 / (
        jnp.pi * (jnp.asarray(cos_t) ** 2 * (1 - alpha) * (1 + alpha) + alpha**2) ** 2
    )


def reflect(direction: Vector, normal: Vector) -> Array:
    """Reflect the unit vector ω = `direction` about the unit vector m = `normal`: 2(ω·m)m − ω."""
    direction, normal = jnp.asarray(direction), jnp.asarray(normal)
    return 2 * (direction @ normal) * normal - direction


def sample_visible_normal(matrix: Matrix, light: Vector, sample: Float[Array, "2"]) -> Array:
    """Draw a microflake normal m that is visible from the unit vector u = `light`.

    Its density is D(m) max(u·m, 0) / σ(u) per steradian. `sample` is uniform in [0, 1)². Returns a
    unit vector (3,).
    """
    return visible_normal(jnp.linalg.cholesky(jnp.asarray(matrix)), light, sample)


def visible_normal(root: Matrix, light: Vector, sample: Float[Array, "2"]) -> Array:
    """Draw a visible normal as `sample_visible_normal` does, from a square root of the matrix.

    `root` L (3, 3) is any matrix with S = LLᵀ. The map p ↦ Lp/|Lp| takes unit vectors p to
    normals m. The visible normals are those with p·Lᵀu > 0, and their p are uniform over the disk
    that is the projection of this half sphere along Lᵀu. So the function draws a uniform point of
    the disk, lifts it to the sphere and maps it by L.
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
    """Return two unit vectors at right angles to `axis` and to each other (Duff et al. 2017)."""
    x, y, z = axis
    sign = jnp.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    b = x * y * a
    return (
        jnp.stack([1 + sign * x * x * a, sign * b, -sign * x]),
        jnp.stack([b, sign + y * y * a, -y]),
    )
