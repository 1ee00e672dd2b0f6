"""The quantities A and B of GGX: with Schlick's Fresnel reflectance F₀ the albedo is F₀ A + B."""

from collections.abc import Callable

from fitting.form import Form
from integrals.microfacet.references import GGX_BIAS as BIAS
from integrals.microfacet.references import GGX_SCALE as SCALE
from integrals.reference import Reference
from quantities.family import Family
from quantities.microfacet.materialx import BIQUADRATIC_BIAS, BIQUADRATIC_SCALE
from quantities.microfacet.shader import calling, hints
from quantities.microfacet.split_forms import candidates, masked_bias, masked_scale
from quantities.problem import Problem


def _problem(
    reference: Reference, published: Form, masked: Callable[..., Form], function: str, what: str
) -> Problem:
    return Problem(
        reference=reference,
        forms=(published,),
        families={
            f"masked-{reference.name}": Family(
                masked, {"numerator": "exponents", "denominator": "exponents"}
            ),
        },
        candidates=lambda _: candidates(masked),
        calling=calling(function, what),
        plot=hints(largest_error=0.02),
        topic="microfacet",
    )


GGX_SCALE = _problem(
    SCALE,
    BIQUADRATIC_SCALE,
    masked_scale,
    "GgxScale",
    "A, the factor of F0 in the albedo F0 A + B of GGX",
)
GGX_BIAS = _problem(
    BIAS,
    BIQUADRATIC_BIAS,
    masked_bias,
    "GgxBias",
    "B, what does not depend on F0 in the albedo F0 A + B of GGX",
)
