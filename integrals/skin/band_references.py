"""The references of z₁ and z₂: the factors of light in spherical harmonics, one for each channel.

The argument is the curvature of the sphere in mm⁻¹.
"""

import jax.numpy as jnp
from jax import Array

from integrals.monte_carlo import Sequence, mean_estimate, unit_points
from integrals.reference import Estimate, Reference, leg
from integrals.rules.interval import gauss_legendre
from integrals.sampling import Sampling
from integrals.skin.references import CHANNELS, CURVATURE
from integrals.skin.scattering import sphere_weights
from shading.skin.profiles import SKIN, GaussianProfile
from shading.types import Scalar

# Nodes of the quadrature. The legs differ by 2e-14, and by 4e-13 for z₂ of red at κ = 4/mm, where
# the closed form cancels.
_NODES = 48
_ERROR, _ERROR_OF_CLOSED_FORM = 5e-14, 8e-13
# The distribution of the depth below the point is below e^(−40) = 4e-18 elsewhere.
_EXPONENT = 40.0
# Less than this times the variance is a plane, to rounding
_PLANE = 1e-24
# e^(−2/s²) is below 4e-44 where the squared width s² is less than this.
_NARROW = 0.02
_SAMPLES = 1 << 16


def band_factor(profile: GaussianProfile, band: int, curvature: Scalar) -> Array:
    """Return z₁ or z₂ of a profile with one channel on a sphere of curvature κ ≥ 0 in mm⁻¹.

    With s = σκ and E = e^(−2/s²), the light of a Gaussian in band 1 is (1 + E) − s² (1 − E) times
    its weight, and that in band 0 is 1 − E. These are the closed forms of `lobe_harmonics`
    multiplied by 1 − E. No step divides by κ, so proofs can bound it on the whole domain.
    """
    k = jnp.asarray(curvature)
    above, below = 0.0, 0.0
    for variance, weight in zip(profile.variances, profile.weights[0], strict=True):
        s2 = variance * (k * k)
        opposite = jnp.exp(-2 / jnp.maximum(s2, _NARROW))
        mass = 1 - opposite
        first = 1 + opposite - s2 * mass
        above = above + weight * (first if band == 1 else mass - 3 * s2 * first)
        below = below + weight * mass
    return jnp.asarray(above / below)


def _legendre(band: int, depth: Array) -> Array:
    """Return P₁ or P₂ of the cosine 1 − depth."""
    cosine = 1 - depth
    return cosine if band == 1 else (3 * cosine * cosine - 1) / 2


def band_reference(band: int, name: str, profile: GaussianProfile) -> Reference:
    """Return the reference of z₁ or z₂ for a profile with one channel; `name` is the channel's."""

    @leg(CURVATURE)
    def closed_form(curvature) -> Estimate:
        return Estimate(band_factor(profile, band, curvature), jnp.full((), _ERROR_OF_CLOSED_FORM))

    @leg(CURVATURE)
    def quadrature(curvature) -> Estimate:
        x, w = gauss_legendre(_NODES, 0.0, 1.0)
        k, sums = jnp.asarray(curvature), []
        for variance, weight in zip(profile.variances, profile.weights[0], strict=True):
            s2 = jnp.maximum(variance * k * k, _PLANE)
            reach = jnp.minimum(2.0, _EXPONENT * s2)
            light = weight * w * (reach / s2) * jnp.exp(-x * (reach / s2))
            sums.append(jnp.stack([light @ _legendre(band, reach * x), light.sum()]))
        above, below = jnp.stack(sums).sum(axis=0)
        return Estimate(above / below, jnp.full((), _ERROR))

    @leg(CURVATURE)
    def monte_carlo(
        curvature, samples: int = _SAMPLES, sequence: Sequence = "random", seed: int = 0
    ) -> Estimate:
        (u,) = jnp.moveaxis(jnp.asarray(unit_points(samples, 1, sequence, seed)), -1, 0)
        s2 = jnp.asarray(profile.variances) * jnp.asarray(curvature) ** 2
        # One minus the cosine of a point, by the inverse of its distribution on the sphere
        wide = jnp.maximum(s2, _PLANE)[:, None, None]
        depth = -wide * jnp.log1p(u * jnp.expm1(-2 / wide))
        w = sphere_weights(profile, curvature)[0]
        found = mean_estimate(jnp.tensordot(w, _legendre(band, depth), axes=1))
        return Estimate(found.value, found.error + _ERROR)

    return Reference(
        name=f"skin-band-{band}-{name}",
        symbol="z₁" if band == 1 else "z₂",
        meaning=f"part of {name} light in band {band} that is left after skin scattered it",
        definition=f"∫ R(|x − y|) P{'₁' if band == 1 else '₂'}(n(x)·n(y)) dy / ∫ R(|x − y|) dy",
        axes=(CURVATURE,),
        sampling=Sampling(fitted=9, checked=11, judged=11),
        closed_form=closed_form,
        quadrature=quadrature,
        monte_carlo=monte_carlo,
    )


BANDS = (1, 2)
SKIN_BANDS = tuple(
    band_reference(band, name, SKIN.channel(k)) for band in BANDS for k, name in enumerate(CHANNELS)
)
