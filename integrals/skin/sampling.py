"""Light that one Gaussian scatters on a ring and on a sphere, by random points."""

import jax.numpy as jnp
from jax import Array

from integrals.monte_carlo import Sequence, mean_estimate, unit_points
from integrals.reference import Estimate
from integrals.skin.lobes import ring_mass
from shading.types import Scalar

_SAMPLES = 1 << 16
# Standard deviations on either side of a point within which the ring is sampled
_REACH = 10.0


def ring_by_sampling(
    theta: Scalar,
    width: Scalar,
    samples: int = _SAMPLES,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Estimate the light at the angle θ of a ring, by even points near θ; see `ring_lobe`."""
    (u,) = jnp.moveaxis(jnp.asarray(unit_points(samples, 1, sequence, seed)), -1, 0)
    # Below this width the surface is a plane to the last digit, but 0 would divide 0.
    s = jnp.maximum(jnp.asarray(width, float), 1e-17)
    reach = jnp.minimum(jnp.pi, _REACH * s)
    x = reach * (2 * u - 1)
    density = jnp.exp(-2 * (jnp.sin(x / 2) / s) ** 2) / (jnp.sqrt(2 * jnp.pi) * s * ring_mass(s))
    return mean_estimate(2 * reach * density * _light(jnp.cos(theta + x)))


def sphere_by_sampling(
    theta: Scalar,
    width: Scalar,
    samples: int = _SAMPLES,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Estimate the light at the angle θ of a sphere, by von Mises–Fisher points around θ."""
    u, v = jnp.moveaxis(jnp.asarray(unit_points(samples, 2, sequence, seed)), -1, 0)
    s2 = jnp.asarray(width, float) ** 2
    # One minus the cosine, by the inverse of its distribution
    depth = -s2 * jnp.log1p(u * jnp.expm1(-2 / s2))
    cosine, sine = 1 - depth, jnp.sqrt(jnp.maximum(depth * (2 - depth), 0.0))
    height = jnp.cos(theta) * cosine + jnp.sin(theta) * sine * jnp.cos(2 * jnp.pi * v)
    return mean_estimate(_light(height))


def _light(cosine: Array) -> Array:
    return jnp.maximum(cosine, 0.0)
