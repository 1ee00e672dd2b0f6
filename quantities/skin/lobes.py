"""The quantities of one Gaussian: light that it scatters on a cylinder and on a sphere.

Any profile that is a sum of Gaussians is a mean of these lobes, whose weights are the Gaussians'
weights times their masses on the surface. So the error for the profile is at most that of a lobe.
"""

from integrals.reference import Reference
from integrals.skin.lobe_references import SKIN_LOBES as REFERENCES
from quantities.calling_convention import Argument, CallingConvention
from quantities.family import Family
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import Problem
from quantities.skin.hill import hill_form
from quantities.skin.hyperbola_forms import (
    ARGUMENTS,
    MOST_WIDTH,
    WIDE,
    candidates,
    hyperbola_form,
    without_denominator,
)

# How the weight of a Gaussian on a surface follows from its weight w in the profile
_WEIGHTS = {
    "cylinder": "w sqrt(2 pi z) exp(-z) I0(z) with z = 1/width^2",
    "sphere": "w (1 - exp(-2/width^2))",
}


def _problem(reference: Reference) -> Problem:
    surface = reference.name.rpartition("-")[2]
    others = (hill_form(reference),) if surface == "sphere" else ()

    def made(**shape):
        return hyperbola_form(reference, **shape)

    return Problem(
        reference=reference,
        forms=(without_denominator(reference), *others),
        families={
            "lobe-skin": Family(made, {**ARGUMENTS, "wide": WIDE}),
        },
        candidates=lambda _: candidates(reference),
        calling=CallingConvention(
            name=f"SkinLobe{surface.capitalize()}",
            summary=f"D, light that a Gaussian scatters on a {surface}; clamps to the domain.",
            arguments=(
                Argument("cosine", "NdotL", clamp="both", local="NdotL"),
                Argument("width", "width", clamp="both", local="width"),
            ),
            remark="NdotL = n·l is not clamped to 0; width is the Gaussian's standard deviation "
            f"times the curvature. Weights in a sum of Gaussians are {_WEIGHTS[surface]}, divided "
            "by their sum",
            codomain=(0.0, 1.0),
        ),
        plot=PlotHints(
            {
                "cosine": AxisHint("$n·l$", -1.0, 1.0, 0.0),
                "width": AxisHint("$σ/r$", 0.0, MOST_WIDTH, 0.4),
            },
            values=(0.0, 1.0),
            largest_error=0.002,
            against="cosine",
        ),
        topic="skin",
    )


LOBE_QUANTITIES = tuple(_problem(each) for each in REFERENCES)
