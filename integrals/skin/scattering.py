"""The light on curved skin: the sum over the Gaussians of a profile.

A wide Gaussian does not find its whole mass on a small ring or sphere. As in Penner's integral, the
sum is divided by the profile's mass on the surface, so that the light is a mean of max(0, cos θ).
"""

import jax
import jax.numpy as jnp
from jax import Array

from integrals.skin.lobes import ring_lobe, ring_mass, sphere_lobe, sphere_mass
from shading.skin.profiles import GaussianProfile
from shading.types import Scalar


def _widths(profile: GaussianProfile, curvature: Scalar) -> Array:
    """Return σ/r of the Gaussians, as an array."""
    return jnp.sqrt(jnp.asarray(profile.variances)) * jnp.asarray(curvature, float)


def ring_weights(profile: GaussianProfile, curvature: Scalar, radial: bool = False) -> Array:
    """Return the weights of the Gaussians' lobes on a ring, (channels, Gaussians).

    `curvature` is in mm⁻¹, ≥ 0. The profile across a line is linear: this is exact on a cylinder.
    `radial` takes the radial profile instead, which loses the light beside the ring.
    """
    w = jnp.asarray(profile.weights)
    if radial:
        w = w / jnp.sqrt(jnp.asarray(profile.variances))
    w = w * ring_mass_of(profile, curvature)
    return w / w.sum(axis=1, keepdims=True)


def ring_mass_of(profile: GaussianProfile, curvature: Scalar) -> Array:
    """Return the masses of the linear Gaussians on a ring, (Gaussians,)."""
    return jax.vmap(ring_mass)(_widths(profile, curvature))


def sphere_weights(profile: GaussianProfile, curvature: Scalar) -> Array:
    """Return the weights of the Gaussians' lobes on a sphere, (channels, Gaussians)."""
    w = jnp.asarray(profile.weights) * jax.vmap(sphere_mass)(_widths(profile, curvature))
    return w / w.sum(axis=1, keepdims=True)


def cylinder_scattering(
    profile: GaussianProfile, theta: Scalar, curvature: Scalar, radial: bool = False
) -> Array:
    """Return D(θ, κ) of each channel (channels,) on a cylinder that is lit across its axis.

    `theta` in [0, π] is the angle of normal and light, `curvature` κ = 1/r ≥ 0 is in mm⁻¹. Without
    `radial` it is the same as the ring's with the linear profile. `radial` takes the radial profile
    on a ring: a widely used mistake. Can be traced and differentiated; for κ = 0 the value is
    max(0, cos θ).
    """
    lobes = jax.vmap(lambda width: ring_lobe(theta, width))(_widths(profile, curvature))
    return ring_weights(profile, curvature, radial) @ lobes


def sphere_scattering(profile: GaussianProfile, theta: Scalar, curvature: Scalar) -> Array:
    """Return D(θ, κ) of each channel (channels,) on a sphere; see `cylinder_scattering`."""
    lobes = jax.vmap(lambda width: sphere_lobe(theta, width))(_widths(profile, curvature))
    return sphere_weights(profile, curvature) @ lobes
