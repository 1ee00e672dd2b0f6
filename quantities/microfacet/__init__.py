"""The quantities of GGX microfacets: E, A and B of its Fresnel split, E_avg, and the samplers."""

from quantities.microfacet.average_albedo import GGX_AVERAGE_ALBEDO as GGX_AVERAGE_ALBEDO
from quantities.microfacet.directional_albedo import (
    GGX_DIRECTIONAL_ALBEDO as GGX_DIRECTIONAL_ALBEDO,
)
from quantities.microfacet.fresnel_split import GGX_BIAS as GGX_BIAS
from quantities.microfacet.fresnel_split import GGX_SCALE as GGX_SCALE
from quantities.microfacet.samplers import SAMPLERS as SAMPLERS
