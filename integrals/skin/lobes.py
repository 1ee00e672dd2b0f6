"""Light that one Gaussian scatters on a ring and on a sphere, by Gauss–Legendre quadrature.

Light falls from the direction θ = 0 with the irradiance max(0, cos θ). A point at the angle θ gets
the mean of it, weighted by a Gaussian of the chord between the points. With s = σ/r the weight at
the angle x from the point is exp(−2 sin²(x/2)/s²). This is a von Mises distribution on the ring,
and a von Mises–Fisher distribution on the sphere, of the concentration 1/s².
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.rules.interval import gauss_legendre
from integrals.special.scaled_i0 import scaled_i0
from shading.types import Scalar

# The weight is below e^(−40) = 4e-18 outside the window.
_EXPONENT = 40.0
# A width of 0 stands for this one, which differs by less than 1e-12.
_LEAST_WIDTH = 1e-12
NODES = 48


def _window(width: Array) -> Array:
    """Return the angle up to which the weight counts; derivatives need not know of it."""
    half = jnp.minimum(1.0, np.sqrt(_EXPONENT / 2) * jax.lax.stop_gradient(width))
    return 2 * jnp.arcsin(half)


def _pieces(nodes: int, *ends: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return nodes and weights on several intervals, one after the other."""
    x, w = gauss_legendre(nodes, 0.0, 1.0)
    at = [lower + (upper - lower) * x for lower, upper in ends]
    return jnp.concatenate(at), jnp.concatenate([(upper - lower) * w for lower, upper in ends])


def ring_mass(width: Scalar) -> Array:
    """Return the mass of a linear Gaussian on a ring, which is 1 on a plane; `width` = σ/r."""
    s = jnp.maximum(jnp.asarray(width, float), _LEAST_WIDTH)
    z = 1 / (s * s)
    return jnp.sqrt(2 * jnp.pi * z) * scaled_i0(z)


def sphere_mass(width: Scalar) -> Array:
    """Return the mass of a radial Gaussian on a sphere, which is 1 on a plane; `width` = σ/r."""
    s = jnp.maximum(jnp.asarray(width, float), _LEAST_WIDTH)
    return -jnp.expm1(-2 / (s * s))


def ring_lobe(theta: Scalar, width: Scalar, nodes: int = NODES) -> Array:
    """Return the light at the angle θ in [0, π] of a ring or cylinder; `width` = σ/r ≥ 0.

    A linear Gaussian on a ring is a radial one on a cylinder. `nodes` are those of one of three
    intervals.
    """
    theta = jnp.asarray(theta, float)
    s = jnp.maximum(jnp.asarray(width, float), _LEAST_WIDTH)
    reach, quarter = _window(s), jnp.pi / 2
    lower = jnp.clip(theta - quarter, -reach, reach)
    upper = jnp.clip(theta + quarter, -reach, reach)
    middle = jnp.clip(0.0, lower, upper)
    # Where the lit half of the ring passes the point opposite to θ
    beyond = jnp.maximum(theta - 3 * quarter, -reach)
    x, w = _pieces(nodes, (lower, middle), (middle, upper), (-reach, beyond))
    weight = jnp.exp(-2 * (jnp.sin(x / 2) / s) ** 2)
    return (w * weight * jnp.cos(theta - x)).sum() / (np.sqrt(2 * np.pi) * s * ring_mass(s))


def sphere_lobe(theta: Scalar, width: Scalar, nodes: int = NODES) -> Array:
    """Return the light at the angle θ in [0, π] of a sphere; `width` = σ/r ≥ 0.

    The integral over the azimuth around the light is a Bessel function. `nodes` are those of one of
    two intervals of the polar angle.
    """
    theta = jnp.asarray(theta, float)
    s = jnp.maximum(jnp.asarray(width, float), _LEAST_WIDTH)
    reach = _window(s)
    lower = jnp.clip(-theta, -reach, reach)
    upper = jnp.clip(jnp.pi / 2 - theta, -reach, reach)
    middle = jnp.clip(0.0, lower, upper)
    x, w = _pieces(nodes, (lower, middle), (middle, upper))
    alpha = theta + x
    z = jnp.sin(alpha) * jnp.sin(theta) / (s * s)
    weight = jnp.exp(-2 * (jnp.sin(x / 2) / s) ** 2) * scaled_i0(z)
    light = jnp.cos(alpha) * jnp.sin(alpha)
    return (w * weight * light).sum() / (s * s * sphere_mass(s))
