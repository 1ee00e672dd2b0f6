"""The quantity E: the directional albedo of GGX."""

from integrals.microfacet.references import GGX_DIRECTIONAL_ALBEDO as REFERENCE
from quantities.family import Family
from quantities.microfacet.albedo_forms import candidates, masked_albedo
from quantities.microfacet.materialx import SPLIT_ALBEDO
from quantities.microfacet.shader import calling, hints
from quantities.problem import Problem

GGX_DIRECTIONAL_ALBEDO = Problem(
    reference=REFERENCE,
    forms=(SPLIT_ALBEDO,),
    families={
        "masked-ggx-directional-albedo": Family(
            masked_albedo, {"numerator": "exponents", "denominator": "exponents"}
        ),
    },
    candidates=lambda _: candidates(),
    calling=calling("GgxDirectionalAlbedo", "E, the albedo of GGX without Fresnel reflectance"),
    plot=hints(largest_error=0.02),
    topic="microfacet",
)
