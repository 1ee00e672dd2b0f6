"""Maps from the unit square to directions, as coordinates for integrals over solid angle.

A map takes x and y in [0, 1] and the values of the axes. It returns a unit vector (3,) and the
Jacobian, the solid angle in steradians per unit of area: the reciprocal of the density of the
directions. The z axis is the normal. The first coordinate is for the polar angle, the second for
the azimuth, 2πy.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike


def hemisphere_angles(x: ArrayLike, y: ArrayLike, *axes: ArrayLike) -> tuple[Array, Array]:
    """Return the direction with polar angle πx/2. The zenith is at x = 0, the horizon at x = 1.

    A function that is smooth on the hemisphere is smooth in these coordinates.
    """
    return _at_angles(jnp.pi / 2, x, y)


def sphere_angles(x: ArrayLike, y: ArrayLike, *axes: ArrayLike) -> tuple[Array, Array]:
    """Return the direction with polar angle πx. The horizon is at x = 1/2."""
    return _at_angles(jnp.pi, x, y)


def cosine_weighted(x: ArrayLike, y: ArrayLike, *axes: ArrayLike) -> tuple[Array, Array]:
    """Return a direction of the hemisphere with the density (cos θ)/π. The zenith is at x = 0.

    It suits Monte Carlo. For quadrature `hemisphere_angles` is better, as a smooth function is not
    smooth in these coordinates: sin θ = √x.
    """
    sine, cosine = jnp.sqrt(x), jnp.sqrt(1 - x)
    return _direction(sine, cosine, y), jnp.pi / cosine


def _at_angles(largest: float, x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
    theta = largest * x
    sine = jnp.sin(theta)
    return _direction(sine, jnp.cos(theta), y), 2 * jnp.pi * largest * sine


def _direction(sine: Array, cosine: Array, y: ArrayLike) -> Array:
    phi = 2 * jnp.pi * y
    return jnp.stack([sine * jnp.cos(phi), sine * jnp.sin(phi), cosine])
