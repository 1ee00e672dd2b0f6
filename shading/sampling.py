"""Random directions that follow the SGGX phase function."""

from jax import Array
from jaxtyping import Float

from shading.sggx import reflect, visible_normal
from shading.types import Matrix, Vector


def sample_phase_function(root: Matrix, light: Vector, sample: Float[Array, "2"]) -> Array:
    """Return a view v (3,) that is drawn with the density p(u, v) per steradian.

    `root` L (3, 3) is any square root of the SGGX matrix, S = LLᵀ. `light` u is a unit vector.
    `sample` is uniform in [0, 1)².

    The function draws a visible normal m and reflects u about it. The normal has the density
    D(m) (u·m)/σ(u), and dω_v = 4 (u·m) dω_m.
    """
    return reflect(light, visible_normal(root, light, sample))
