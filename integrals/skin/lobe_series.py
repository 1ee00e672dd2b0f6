"""Light that one Gaussian scatters on a ring and on a sphere, as Fourier and Legendre series.

The Gaussian multiplies the term ℓ of max(0, cos θ) by a ratio of Bessel functions of z = r²/σ²: by
I_ℓ/I₀ on the ring, and by I_{ℓ+½}/I_{½} on the sphere. The ratios come from downward recurrence,
because JAX has only I₀ and I₁. The series need about 12 r/σ terms.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.types import Scalar

# Terms for which σ/r ≥ 0.0027 is exact to rounding: all Gaussians of skin, and r ≤ 30 mm
TERMS = 5000


def ring_series(theta: Scalar, width: Scalar, terms: int = TERMS) -> Array:
    """Return the light at the angle θ of a ring; `width` = σ/r > 0. See `ring_lobe`."""
    order = np.arange(terms)
    a = np.zeros(terms)
    a[0], a[1] = 1 / np.pi, 0.5
    even = order[2::2]
    a[2::2] = 2 / np.pi * np.where(even % 4, 1, -1) / (even**2 - 1.0)
    return _sum(jnp.asarray(a) * jnp.cos(order * theta), width, 0.0)


def sphere_series(theta: Scalar, width: Scalar, terms: int = TERMS) -> Array:
    """Return the light at the angle θ of a sphere; `width` = σ/r > 0. See `sphere_lobe`."""
    c = np.zeros(terms)
    c[0], c[1], c[2] = 0.5, 1 / 3, 1 / 8
    for k in range(2, terms - 2, 2):
        c[k + 2] = -c[k] * (k - 1) / (k + 4)
    a = (2 * np.arange(terms) + 1) / 2 * c
    mu = jnp.cos(theta)

    def next_legendre(pair, order):
        below, this = pair
        above = ((2 * order + 1) * mu * this - order * below) / (order + 1)
        return (this, above), below

    _, legendre = jax.lax.scan(
        next_legendre, (jnp.ones_like(mu), mu), jnp.arange(1, terms + 1, dtype=float)
    )
    return _sum(a * legendre, width, 0.5)


def _sum(terms: Array, width: Scalar, shift: float) -> Array:
    """Return Σ terms_ℓ I_{ℓ+shift}/I_{shift}, from the last term to the first."""
    inverse = jnp.asarray(width, float) ** 2

    def step(state, each):
        total, ratio = state
        order, term = each
        # notation: `ratio` is I_{ν+1}/I_ν with ν = order + shift, `below` is I_ν/I_{ν−1}
        below = 1 / (2 * (order + shift) * inverse + ratio)
        return (term + ratio * total, below), None

    order = jnp.arange(terms.shape[0], dtype=float)
    zero = jnp.zeros(())
    (total, _), _ = jax.lax.scan(step, (zero, zero), (order, terms), reverse=True)
    return total
