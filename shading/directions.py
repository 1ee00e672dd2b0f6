"""Unit vectors from angles, and the cosines and sines between them.

The z axis of the frame is the surface normal n. Angles are in radians.
"""

import jax.numpy as jnp
from jax import Array

from shading.types import Scalar


def direction(theta: Scalar, phi: Scalar) -> Array:
    """Return the unit vector (3,) of polar angle `theta` and azimuth `phi`, in radians.

    The azimuth is zero in the direction of the fibre, so the fibre lies in the plane y = 0.
    """
    sin_theta = jnp.sin(theta)
    return jnp.stack([sin_theta * jnp.cos(phi), sin_theta * jnp.sin(phi), jnp.cos(theta)])


def fiber_direction(theta_f: Scalar) -> Array:
    """Return the fibre direction t = (sin θf, 0, cos θf). At θf = 0 the fibre is the normal."""
    return direction(theta_f, 0.0)


def direction_cosines(theta_f: Scalar, theta: Scalar, cos_phi: Scalar) -> tuple[Array, Array]:
    """Return u·n and u·t for the direction u and the fibre t.

    `theta` and `theta_f` are the polar angles of u and t in radians. `cos_phi` is the cosine of
    the azimuth between them.
    """
    cos_un = jnp.cos(theta)
    in_plane = jnp.sin(theta) * cos_phi * jnp.sin(theta_f)
    return cos_un, in_plane + cos_un * jnp.cos(theta_f)


def sin2_between(theta_a: Scalar, theta_b: Scalar, phi: Scalar) -> Array:
    """Return the squared sine of the angle between two directions.

    `theta_a` and `theta_b` are their polar angles and `phi` is the difference of their azimuths,
    in radians. The formula uses half angles. It keeps full relative precision even where the
    cosine of the angle rounds to 1 or −1.
    """
    theta_a, theta_b = jnp.asarray(theta_a), jnp.asarray(theta_b)
    sines = jnp.sin(theta_a) * jnp.sin(theta_b)
    less = jnp.sin((theta_a - theta_b) / 2) ** 2 + sines * jnp.sin(phi / 2) ** 2
    more = jnp.cos((theta_a + theta_b) / 2) ** 2 + sines * jnp.cos(phi / 2) ** 2
    return 4 * less * more
