"""The references of GGX albedos: E, its Fresnel split A and B, and the average E_avg.

A coefficient table is for α ≥ 0.01. The exact values are offered below that too.
"""

from collections.abc import Callable

import numpy as np

from integrals.microfacet.average_albedo import average_albedo
from integrals.microfacet.directional_albedo import directional_albedo
from integrals.microfacet.fresnel_split import fresnel_split
from integrals.microfacet.monte_carlo import directional_albedo_by_sampling
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling

MU = Axis("mu", 0.0, 1.0, "μ", meaning="cosine of view and normal, v·n", scale="square")
ALPHA = Axis(
    "alpha",
    0.001,
    1.0,
    "α",
    meaning="width of GGX, the square of perceptual roughness",
    scale="logarithmic",
)
AXES = (MU, ALPHA)
# For α ≥ 0.01 and this many nodes and azimuths, A and B are exact to 1e-5, and mostly to 1e-8.
_NODES, _AZIMUTHS = 48, 64
# E has a dip at μ ≈ α. The further points have μ/α between these, evenly in the logarithm.
_LEAST_RATIO, _LARGEST_RATIO = 0.02, 50.0


@leg(*AXES)
def _directional(mu, alpha) -> Estimate:
    """Evaluate E by the one-dimensional integral over the cosine of the light."""
    return directional_albedo(mu, alpha)


@leg(*AXES)
def _scale(mu, alpha) -> Estimate:
    """Evaluate A by the integral over the cosine and the azimuth of the light."""
    return fresnel_split(mu, alpha, nodes=_NODES, azimuths=_AZIMUTHS).scale


@leg(*AXES)
def _bias(mu, alpha) -> Estimate:
    """Evaluate B by the integral over the cosine and the azimuth of the light."""
    return fresnel_split(mu, alpha, nodes=_NODES, azimuths=_AZIMUTHS).offset


@leg(*AXES)
def _scale_by_sampling(mu, alpha, **options) -> Estimate:
    return directional_albedo_by_sampling(mu, alpha, fresnel=lambda c: 1 - (1 - c) ** 5, **options)


@leg(*AXES)
def _bias_by_sampling(mu, alpha, **options) -> Estimate:
    return directional_albedo_by_sampling(mu, alpha, fresnel=lambda c: (1 - c) ** 5, **options)


@leg(ALPHA)
def _average(alpha) -> Estimate:
    """Evaluate E_avg by the one-dimensional integral of elementary functions."""
    return average_albedo(alpha)


def near_the_dip(points: np.ndarray) -> np.ndarray:
    """Return points of μ and α that are graded in μ/α, one for two of `points` (n, 2).

    They keep their α. However small α is, E as a function of μ/α has a dip that is 0.11 deep.
    """
    points = points[::2]
    fraction = np.sqrt(points[:, 0])
    ratio = _LEAST_RATIO * (_LARGEST_RATIO / _LEAST_RATIO) ** fraction
    return np.stack([np.minimum(points[:, 1] * ratio, 1.0), points[:, 1]], axis=1)


def _split(
    name: str,
    symbol: str,
    meaning: str,
    definition: str,
    quadrature: Callable,
    monte_carlo: Callable,
) -> Reference:
    return Reference(
        name=name,
        symbol=symbol,
        meaning=meaning,
        definition=definition,
        axes=AXES,
        sampling=Sampling(
            fitted=10, checked=11, judged=12, climbs=False, extra=near_the_dip, verified=1 << 12
        ),
        quadrature=quadrature,
        monte_carlo=monte_carlo,
        batch=256,
    )


GGX_DIRECTIONAL_ALBEDO = Reference(
    name="ggx-directional-albedo",
    symbol="E",
    meaning="directional albedo of GGX without Fresnel reflectance, height-correlated masking",
    definition="∫_Ω f(v, l) (l·n) dω_l",
    axes=AXES,
    sampling=Sampling(fitted=12, checked=14, judged=14, extra=near_the_dip, verified=1 << 14),
    quadrature=_directional,
    monte_carlo=leg(*AXES)(directional_albedo_by_sampling),
    batch=1024,
)
GGX_SCALE = _split(
    "ggx-scale",
    "A",
    "factor of F₀ in the albedo F₀ A + B of GGX with Schlick's Fresnel reflectance",
    "∫_Ω f(v, l) (1 − (1 − v·h)⁵) (l·n) dω_l",
    _scale,
    _scale_by_sampling,
)
GGX_BIAS = _split(
    "ggx-bias",
    "B",
    "what does not depend on F₀ in the albedo F₀ A + B of GGX with Schlick's Fresnel reflectance",
    "∫_Ω f(v, l) (1 − v·h)⁵ (l·n) dω_l",
    _bias,
    _bias_by_sampling,
)
GGX_AVERAGE_ALBEDO = Reference(
    name="ggx-average-albedo",
    symbol="E_avg",
    meaning="cosine-weighted average over views of the directional albedo of GGX",
    definition="2 ∫₀¹ E(μ, α) μ dμ",
    axes=(ALPHA,),
    sampling=Sampling(fitted=10, checked=12, judged=12, climbs=False),
    quadrature=_average,
    batch=256,
)
