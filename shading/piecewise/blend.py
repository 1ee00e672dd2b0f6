"""The anisotropic blend of two isotropic profiles, D_x at azimuth 0 and D_y at π/2.

D(θ, φ) = (cos²φ D_x(θ) D_y(0) + sin²φ D_y(θ) D_x(0)) / c with c = (D_x(0) + D_y(0))/2 (Eq. 1 to 3).
It is a mixture: cos²φ/π is a density of azimuths, so D_x has the weight D_y(0)/(2c), and D_y has
D_x(0)/(2c).
"""

import equinox as eqx
import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike

from shading.piecewise.ndf import Profile, density
from shading.types import Scalar


class Blend(eqx.Module):
    """Two normalised profiles: `x` at azimuth 0, `y` at π/2. They may have different knots."""

    x: Profile
    y: Profile


def weights(blend: Blend) -> tuple[Array, Array]:
    """Return the weights of D_x and D_y in the mixture, which add up to 1.

    If one of D_x(0) and D_y(0) is zero, that profile has all the weight. If both are, both weights
    are ½: this is the formula that the paper gives for this case. It is no limit of Eq. 1, whose
    limit depends on how both become zero.
    """
    x, y = blend.x.values[0], blend.y.values[0]
    total = x + y
    none = total == 0
    share = jnp.where(none, 0.5, y / jnp.where(none, 1.0, total))
    return share, 1 - share


def blend_density(blend: Blend, theta: Scalar, phi: Scalar) -> Array:
    """Return D(θ, φ), per steradian, at polar angle θ in [0, π/2] and azimuth φ, in radians."""
    x, y = weights(blend)
    along, across = jnp.cos(phi) ** 2, jnp.sin(phi) ** 2
    return 2 * (x * along * density(blend.x, theta) + y * across * density(blend.y, theta))


def azimuth_cdf(blend: Blend, phi: ArrayLike) -> Array:
    """Return the part of the normals with azimuths from 0 to φ in [0, 2π], elementwise (Eq. 7)."""
    x, y = weights(blend)
    phi = jnp.asarray(phi)
    return phi / (2 * jnp.pi) + (x - y) / (4 * jnp.pi) * jnp.sin(2 * phi)
