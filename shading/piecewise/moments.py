"""Integrals of a piecewise-linear NDF over the polar angle: its mass and its moment.

The mass is T = 2π ∫ D cos θ sin θ dθ (Eq. 5), which is 1 for a normalised NDF. The moment is
A = ∫ D sin²θ dθ (Eq. 15); Λ(θo) → 2A tan θo as θo → π/2. The formulas are those of Eq. 5 and 15,
written about the middle of each segment: the printed ones cancel where segments are narrow.
"""

import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from shading.piecewise.defects import chord_defect, sine_defect
from shading.piecewise.ndf import Profile, density, segment_of, squared_sine_steps

# ∫ D sin²θ of a segment that is linear in cos²θ: the integrand is a trigonometric polynomial of
# degree four, for which this many Gauss points are exact to rounding even on all of [0, π/2].
_NODES = 16


def segment_mass(
    variable: str, lower: ArrayLike, upper: ArrayLike, low: ArrayLike, high: ArrayLike
) -> Array:
    """Return 2π ∫ D cos θ sin θ dθ over a segment, elementwise.

    `lower` and `upper` are its ends in radians. `low` and `high` are the values of D there.
    `variable` is what D is linear in.
    """
    lower, upper, low, high = (jnp.asarray(each) for each in (lower, upper, low, high))
    mean = (low + high) / 2
    if variable == "cos2":
        # D is linear in sin²θ, and 2 cos θ sin θ dθ = d sin²θ: the trapezoid rule is exact.
        return jnp.pi * mean * squared_sine_steps(lower, upper)
    middle, width = (lower + upper) / 2, upper - lower
    slope = (high - low) / jnp.where(width == 0, 1.0, width)
    even = mean * jnp.sin(2 * middle) * jnp.sin(width)
    odd = slope / 2 * jnp.cos(2 * middle) * chord_defect(width)
    return jnp.pi * (even + odd)


def masses(ndf: Profile) -> Array:
    """Return the mass (n − 1,) of each segment."""
    left, right = ndf.knots[:-1], ndf.knots[1:]
    return segment_mass(ndf.variable, left, right, ndf.values[:-1], ndf.values[1:])


def mass(ndf: Profile) -> Array:
    """Return c_iso = ∫ D cos θ dω, the normalisation of an isotropic NDF (Eq. 5)."""
    return jnp.sum(masses(ndf))


def normalised(ndf: Profile) -> Profile:
    """Return the NDF divided by its mass."""
    return Profile(ndf.knots, ndf.values / mass(ndf), ndf.variable)


def mass_below(ndf: Profile, theta: ArrayLike) -> Array:
    """Return 2π ∫₀^θ D cos θ′ sin θ′ dθ′, elementwise.

    It is the CDF of θ for a normalised NDF.
    """
    k = segment_of(ndf, theta)
    before = jnp.concatenate([jnp.zeros(1), jnp.cumsum(masses(ndf))])[k]
    left, value = ndf.knots[k], ndf.values[k]
    return before + segment_mass(ndf.variable, left, theta, value, density(ndf, theta))


def moment(ndf: Profile) -> Array:
    """Return A = ∫ D sin²θ dθ over [0, π/2] (Eq. 15)."""
    left, right = ndf.knots[:-1], ndf.knots[1:]
    low, high = ndf.values[:-1], ndf.values[1:]
    if ndf.variable == "angle":
        middle, width = (left + right) / 2, right - left
        level = sine_defect(width) / 2 + jnp.sin(middle) ** 2 * jnp.sin(width)
        tilt = jnp.sin(2 * middle) * chord_defect(width) / 4
        return jnp.sum((low + high) / 2 * level + (high - low) / width * tilt)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    at = left[:, None] + (right - left)[:, None] * (nodes + 1) / 2
    part = squared_sine_steps(left[:, None], at) / squared_sine_steps(left, right)[:, None]
    values = low[:, None] + (high - low)[:, None] * part
    return jnp.sum((right - left)[:, None] / 2 * weights * values * jnp.sin(at) ** 2)
