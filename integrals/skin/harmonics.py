"""Light in spherical harmonics that skin scatters: the factor of each band, on a sphere.

A Gaussian multiplies the band ℓ of the irradiance by ρ_ℓ = I_{ℓ+½}/I_{½}, which is elementary.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.skin.scattering import sphere_weights
from shading.skin.profiles import GaussianProfile
from shading.types import Scalar

# Where the closed forms cancel, the continued fraction takes over; with so many terms it is exact.
_SMALL, _TERMS = 0.5, 12


def lobe_harmonics(width: Scalar) -> Array:
    """Return ρ₁ and ρ₂ (2,) of a Gaussian on a sphere; `width` = σ/r > 0.

    ρ₁ = coth z − 1/z and ρ₂ = 1 − 3ρ₁/z, with z = r²/σ². For small z, ρ₁ is a continued fraction.
    """
    s2 = jnp.asarray(width, float) ** 2
    # Each form gets a width for which it is exact, so that derivatives are finite too
    large, small = jnp.minimum(s2, 1 / _SMALL), jnp.maximum(s2, 1 / _SMALL)
    first = 1 / jnp.tanh(1 / jnp.maximum(large, 1e-300)) - large
    second = 1 - 3 * first * large
    ratio = jnp.zeros_like(s2)
    ratios = []
    for order in range(_TERMS, 0, -1):
        ratio = 1 / ((2 * order + 1) * small + ratio)
        ratios.append(ratio)
    closed, fraction = jnp.stack([first, second]), jnp.stack([ratios[-1], ratios[-1] * ratios[-2]])
    return jnp.where(s2 < 1 / _SMALL, closed, fraction)


def harmonic_factors(profile: GaussianProfile, curvature: Scalar) -> Array:
    """Return z₁ and z₂ of each channel (channels, 2) on a sphere; the factor of band 0 is 1.

    They multiply the bands of the irradiance in spherical harmonics, which a surface that does not
    scatter would have. `curvature` ≥ 0 is in mm⁻¹.
    """
    widths = jnp.sqrt(jnp.asarray(profile.variances)) * jnp.asarray(curvature, float)
    return sphere_weights(profile, curvature) @ jax.vmap(lobe_harmonics)(widths)


def burley_harmonics(shape: Scalar, curvature: Scalar) -> Array:
    """Return z₁ and z₂ (2,) of Burley's profile on a sphere, for b = `shape` and κ > 0.

    On a sphere, a chord's length is evenly distributed in its square. So the factors are integrals
    of powers and exponentials, here by their closed forms.
    """
    b, reach = jnp.asarray(shape, float), 2 / jnp.asarray(curvature, float)
    # notation: S_n = ∫₀^{2r} (d/2r)ⁿ (e^(−d/b) + e^(−d/3b)) dd
    moments = [sum(_moment(n, reach / (f * b)) for f in (1, 3)) for n in (0, 2, 4)]
    s0, s2, s4 = moments
    return jnp.stack([1 - 2 * s2 / s0, 1 - 6 * s2 / s0 + 6 * s4 / s0])


def _moment(power: int, x: Array) -> Array:
    """Return ∫₀¹ tⁿ e^(−xt) dt by parts: n!/xⁿ⁺¹ (1 − e^(−x) Σ_{k≤n} xᵏ/k!)."""
    k = np.arange(power + 1)
    factorials = np.cumprod(np.maximum(k, 1)).astype(float)
    tail = jnp.exp(-x) * (x**k / factorials).sum()
    return factorials[-1] * (1 - tail) / x ** (power + 1)
