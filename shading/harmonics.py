"""Real spherical harmonics up to order 2, which represent ambient light.

The radiance is L(ω) = Σ Lᵢ Yᵢ(ω). Its nine coefficients Lᵢ have the shape (9,), or (9, 3) for
colours. They are ordered by the band l and, within a band, by m = −l … l.

The integrals over a hemisphere use the Funk–Hecke theorem: an integral against a kernel that
depends on ω·n only multiplies band l by the integral of the kernel times Legendre's polynomial P_l.
"""

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from shading.types import Vector

Coefficients = Float[Array | np.ndarray, "9 *channels"]

# The factors of Y₀₀, of order 1, of order 2, and of Y₂₀
FLAT, FIRST = float(np.sqrt(1 / (4 * np.pi))), float(np.sqrt(3 / (4 * np.pi)))
SECOND, ZONAL = float(np.sqrt(15 / (4 * np.pi))), float(np.sqrt(5 / (16 * np.pi)))
_BANDS = np.array([0, 1, 1, 1, 2, 2, 2, 2, 2])
# The coefficients of light with the radiance one everywhere
UNIFORM = np.sqrt(4 * np.pi) * (np.arange(9) == 0)
# The coefficients of the broad lobe ((1 + ω·s)/2)² = 1/3 + (ω·s)/2 + P₂(ω·s)/6 about a unit vector
# s are these times the harmonics at s, by the addition theorem of spherical harmonics. It needs no
# harmonics beyond order 2, and is never negative.
LOBE = np.array([1 / 3, 1 / 2, 1 / 6])[_BANDS] * 4 * np.pi / (2 * _BANDS + 1)
# For l = 0, 1, 2: 2π ∫₀¹ P_l(x) x dx (irradiance) and ∫₀¹ P_l(x) dx (mean radiance).
_COSINE = np.array([np.pi, 2 * np.pi / 3, np.pi / 4])[_BANDS]
_MEAN = np.array([1.0, 0.5, 0.0])[_BANDS]


def harmonics(direction: Vector) -> Array:
    """Return Y₀₀ … Y₂₂ (9,) of a unit vector. They are orthonormal over the sphere."""
    x, y, z = jnp.asarray(direction)
    return jnp.stack(
        [
            jnp.full_like(z, FLAT),
            *(FIRST * y, FIRST * z, FIRST * x),
            *(SECOND * x * y, SECOND * y * z),
            ZONAL * (3 * z * z - 1),
            *(SECOND * x * z, SECOND * (x * x - y * y) / 2),
        ]
    )


def radiance(light: Coefficients, direction: Vector) -> Array:
    """Return the radiance L(ω). It is negative where the expansion overshoots."""
    return harmonics(direction) @ light


def irradiance(light: Coefficients, normal: Vector) -> Array:
    """Return the irradiance E = ∫_Ω L(ω) (ω·n) dω. Ω is the hemisphere about the unit vector n."""
    return (_COSINE * harmonics(normal)) @ light


def mean_radiance(light: Coefficients, normal: Vector) -> Array:
    """Return (1/2π) ∫_Ω L(ω) dω, the mean over the hemisphere Ω about the unit vector n."""
    return (_MEAN * harmonics(normal)) @ light
