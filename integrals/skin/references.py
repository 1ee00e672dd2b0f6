"""The references of light on curved skin, one for each channel: on a cylinder and on a sphere.

The arguments are the cosine of normal and light, which may be negative, and the curvature in mm⁻¹.
"""

import jax.numpy as jnp
from jax import Array

from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from integrals.skin.lobes import ring_lobe, sphere_lobe
from integrals.skin.sampling import ring_by_sampling, sphere_by_sampling
from integrals.skin.scattering import ring_weights, sphere_weights
from shading.skin.profiles import SKIN, GaussianProfile

COSINE = Axis("cosine", -1.0, 1.0, "c", meaning="cosine of normal and light, n·l, not clamped")
CURVATURE = Axis(
    "curvature", 0.0, 4.0, "κ", meaning="curvature of the surface in mm⁻¹, 1/r", scale="square"
)
AXES = (COSINE, CURVATURE)
CHANNELS = ("red", "green", "blue")
# Nodes of the quadrature, for which the values differ by 2e-14 from those with three times as many.
_NODES, _ERROR = 32, 1e-13
# The angle is that of a cosine which is this much nearer to 0, where its derivative is finite.
_SHRINK = 1 - 1e-14
_SURFACES = {
    "cylinder": (ring_lobe, ring_weights, ring_by_sampling),
    "sphere": (sphere_lobe, sphere_weights, sphere_by_sampling),
}


def angle_of(cosine) -> Array:
    """Return the angle of a cosine in [−1, 1], with finite derivatives."""
    c = cosine * _SHRINK
    return jnp.arctan2(jnp.sqrt((1 - c) * (1 + c)), c)


def channel_reference(surface: str, name: str, profile: GaussianProfile) -> Reference:
    """Return the reference of a profile with one channel, on 'cylinder' or 'sphere'.

    `name` is that of the channel.
    """
    lobe, weights, by_sampling = _SURFACES[surface]
    deviations = [v**0.5 for v in profile.variances]

    @leg(*AXES)
    def quadrature(cosine, curvature) -> Estimate:
        theta, w = angle_of(cosine), weights(profile, curvature)[0]
        lobes = [lobe(theta, s * curvature, nodes=_NODES) for s in deviations]
        return Estimate(w @ jnp.stack(lobes), jnp.full((), _ERROR))

    @leg(*AXES)
    def monte_carlo(cosine, curvature, **options) -> Estimate:
        theta, w = angle_of(cosine), weights(profile, curvature)[0]
        found = [by_sampling(theta, s * curvature, **options) for s in deviations]
        return Estimate(
            w @ jnp.stack([each.value for each in found]),
            # The same random numbers serve all Gaussians, so that their errors may add up. On a
            # plane only rounding is left.
            w @ jnp.stack([each.error for each in found]) + _ERROR,
        )

    return Reference(
        name=f"skin-{surface}-{name}",
        symbol="D",
        meaning=f"{name} light that skin scatters on a {surface}",
        definition="∫ R(|x − y|) max(0, n(y)·l) dy / ∫ R(|x − y|) dy",
        axes=AXES,
        sampling=Sampling(fitted=11, checked=13, judged=14, verified=1 << 12),
        quadrature=quadrature,
        monte_carlo=monte_carlo,
        batch=1024,
    )


CYLINDER = tuple(channel_reference("cylinder", n, SKIN.channel(k)) for k, n in enumerate(CHANNELS))
SPHERE = tuple(channel_reference("sphere", n, SKIN.channel(k)) for k, n in enumerate(CHANNELS))
SKIN_REFERENCES = (*CYLINDER, *SPHERE)
