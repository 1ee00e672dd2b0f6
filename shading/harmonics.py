"""Real spherical harmonics up to second order, the light of the ambient model.

Radiance L(ω) = Σ Lᵢ Yᵢ(ω) has nine coefficients Lᵢ, (9,) or (9, 3) for colours, ordered by band l
and, within it, by m = −l … l. The integrals over a hemisphere follow from Funk and Hecke's theorem:
they multiply band l by the integral of its Legendre polynomial.
"""

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from shading.types import Vector

Coefficients = Float[Array | np.ndarray, "9 *channels"]

_BANDS = np.array([0, 1, 1, 1, 2, 2, 2, 2, 2])
# 2π ∫₀¹ P_l(x) x dx and ∫₀¹ P_l(x) dx for l = 0, 1, 2.
_COSINE = np.array([np.pi, 2 * np.pi / 3, np.pi / 4])[_BANDS]
_MEAN = np.array([1.0, 0.5, 0.0])[_BANDS]


def harmonics(direction: Vector) -> Array:
    """Give Y₀₀ … Y₂₂ (9,) of a unit vector; they are orthonormal over the sphere."""
    x, y, z = jnp.asarray(direction)
    flat = jnp.full_like(z, np.sqrt(1 / (4 * np.pi)))
    first = np.sqrt(3 / (4 * np.pi))
    second = np.sqrt(15 / (4 * np.pi))
    return jnp.stack(
        [
            flat,
            *(first * y, first * z, first * x),
            *(second * x * y, second * y * z),
            np.sqrt(5 / (16 * np.pi)) * (3 * z * z - 1),
            *(second * x * z, second * (x * x - y * y) / 2),
        ]
    )


def radiance(light: Coefficients, direction: Vector) -> Array:
    """Give L(ω), per steradian; negative where the expansion rings."""
    return harmonics(direction) @ light


def irradiance(light: Coefficients, normal: Vector) -> Array:
    """Give E = ∫_Ω L(ω) (ω·n) dω over the hemisphere about the unit vector n."""
    return (_COSINE * harmonics(normal)) @ light


def mean_radiance(light: Coefficients, normal: Vector) -> Array:
    """Give (1/2π) ∫_Ω L(ω) dω, the average over the hemisphere about the unit vector n."""
    return (_MEAN * harmonics(normal)) @ light
