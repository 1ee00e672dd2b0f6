"""Unit vectors from angles, in the frame whose z axis is the surface normal n."""

import jax.numpy as jnp
from jax import Array

from shading.types import Scalar


def direction(theta: Scalar, phi: Scalar) -> Array:
    """Give the unit vector of polar angle `theta` and azimuth `phi`, both in radians.

    The azimuth is measured from the fibre's, so that the fibre lies in the plane y = 0.
    """
    sin_theta = jnp.sin(theta)
    return jnp.stack([sin_theta * jnp.cos(phi), sin_theta * jnp.sin(phi), jnp.cos(theta)])


def fiber_direction(theta_f: Scalar) -> Array:
    """Give the fibre direction t = (sin θf, 0, cos θf); θf = 0 is a fibre along the normal."""
    return direction(theta_f, 0.0)
