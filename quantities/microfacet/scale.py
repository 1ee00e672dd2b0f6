"""The quantity A of GGX: with Schlick's Fresnel reflectance F₀ the albedo is F₀ A + B."""

from integrals.microfacet.references import GGX_SCALE as REFERENCE
from quantities.family import Family
from quantities.microfacet.materialx import BIQUADRATIC_SCALE
from quantities.microfacet.shader import calling, hints
from quantities.microfacet.split_forms import candidates, masked_scale
from quantities.problem import Problem

GGX_SCALE = Problem(
    reference=REFERENCE,
    forms=(BIQUADRATIC_SCALE,),
    families={
        "masked-ggx-scale": Family(
            masked_scale, {"numerator": "exponents", "denominator": "exponents"}
        ),
    },
    candidates=lambda _: candidates(masked_scale),
    calling=calling("GgxScale", "A, the factor of F0 in the albedo F0 A + B of GGX"),
    plot=hints(largest_error=0.02),
    topic="microfacet",
)
