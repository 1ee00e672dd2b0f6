"""The references of filtered widths: w(u) for an even spread, and w₁(u₁, u₂) for two axes."""

from integrals.maps.filtered_width import axis_widening, axis_widening_by_sampling, widening
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling

_MEANING = "v/(α² + v), with the squared width α² and the variance v of slopes{}"
SHARE = Axis("share", 0.0, 1.0, "u", meaning=_MEANING.format(""))
ALONG = Axis("along", 0.0, 1.0, "u₁", meaning=_MEANING.format(" along the axis"))
ACROSS = Axis("across", 0.0, 1.0, "u₂", meaning=_MEANING.format(" across the axis"))
_DEFINITION = "argmax_w ∫ p(s) ln p_w(s) ds, p: slopes of GGX spread by a Gaussian"


@leg(SHARE)
def _widening(share) -> Estimate:
    """Evaluate w by the one-dimensional integral with the exponential integral."""
    return widening(share)


@leg(SHARE)
def _widening_by_sampling(share, **options) -> Estimate:
    return axis_widening_by_sampling(share, share, **options)


@leg(ALONG, ACROSS)
def _axis_widening(along, across) -> Estimate:
    """Evaluate w₁ by the two-dimensional integral of elementary functions."""
    return axis_widening(along, across)


SGGX_FILTER = Reference(
    name="sggx-filter",
    symbol="w",
    meaning="squared width of the best GGX lobe for spread normals, divided by α² + v",
    definition=_DEFINITION,
    axes=(SHARE,),
    sampling=Sampling(fitted=9, checked=11, judged=11, climbs=False),
    quadrature=_widening,
    monte_carlo=_widening_by_sampling,
    batch=1024,
    codomain=(1.0, 2.0),
)
SGGX_FILTER_AXES = Reference(
    name="sggx-filter-axes",
    symbol="w₁",
    meaning="squared width along an axis of the best GGX lobe for spread normals, by α₁² + v₁",
    definition=_DEFINITION,
    axes=(ALONG, ACROSS),
    sampling=Sampling(fitted=10, checked=12, judged=12, climbs=False, verified=1 << 12),
    quadrature=_axis_widening,
    monte_carlo=leg(ALONG, ACROSS)(axis_widening_by_sampling),
    batch=256,
    codomain=(1.0, 2.0),
)
