"""Directions drawn from the SGGX phase function by its visible normals."""

from jax import Array
from jaxtyping import Float

from shading.sggx import reflect, visible_normal
from shading.types import Matrix, Vector


def sample_phase_function(root: Matrix, light: Vector, sample: Float[Array, "2"]) -> Array:
    """Draw v with density p(u, v) per steradian: mirror u about a visible normal.

    `root` L (3, 3) with S = LLᵀ; `light` u is a unit vector; `sample` is uniform in [0, 1)². The
    normal has density D(m) (u·m)/σ(u), and dω_v = 4 (u·m) dω_m.
    """
    return reflect(light, visible_normal(root, light, sample))
