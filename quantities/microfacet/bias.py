"""The quantity B of GGX: with Schlick's Fresnel reflectance F₀ the albedo is F₀ A + B."""

from integrals.microfacet.references import GGX_BIAS as REFERENCE
from quantities.family import Family
from quantities.microfacet.materialx import BIQUADRATIC_BIAS
from quantities.microfacet.shader import calling, hints
from quantities.microfacet.split_forms import candidates, masked_bias
from quantities.problem import Problem

GGX_BIAS = Problem(
    reference=REFERENCE,
    forms=(BIQUADRATIC_BIAS,),
    families={
        "masked-ggx-bias": Family(
            masked_bias, {"numerator": "exponents", "denominator": "exponents"}
        ),
    },
    candidates=lambda _: candidates(masked_bias),
    calling=calling("GgxBias", "B, what does not depend on F0 in the albedo F0 A + B of GGX"),
    plot=hints(largest_error=0.02),
    topic="microfacet",
)
