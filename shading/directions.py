"""Unit vectors and their cosines from angles, in the frame whose z axis is the surface normal n."""

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


def direction_cosines(theta_f: Scalar, theta: Scalar, cos_phi: Scalar) -> tuple[Array, Array]:
    """Give u·n and u·t of `direction(theta, phi)` and the fibre of polar angle `theta_f`.

    Both angles are in radians; `cos_phi` is the cosine of the azimuth between u and t.
    """
    cos_un = jnp.cos(theta)
    in_plane = jnp.sin(theta) * cos_phi * jnp.sin(theta_f)
    return cos_un, in_plane + cos_un * jnp.cos(theta_f)


def sin2_between(theta_a: Scalar, theta_b: Scalar, phi: Scalar) -> Array:
    """Give the squared sine of the angle between two directions whose azimuths differ by `phi`.

    From half angles, all in radians: of full relative precision where the cosine rounds to ±1.
    """
    theta_a, theta_b = jnp.asarray(theta_a), jnp.asarray(theta_b)
    sines = jnp.sin(theta_a) * jnp.sin(theta_b)
    less = jnp.sin((theta_a - theta_b) / 2) ** 2 + sines * jnp.sin(phi / 2) ** 2
    more = jnp.cos((theta_a + theta_b) / 2) ** 2 + sines * jnp.cos(phi / 2) ** 2
    return 4 * less * more
