"""The quantities D: red, green and blue light that skin scatters on a cylinder and on a sphere."""

import itertools

from integrals.reference import Reference
from integrals.skin.references import SKIN_REFERENCES
from quantities.calling_convention import Argument, CallingConvention
from quantities.family import Family
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import Problem
from quantities.skin.hyperbola_forms import (
    ARGUMENTS,
    candidates,
    hyperbola_form,
    without_denominator,
)
from quantities.skin.pesce import pesce_form
from quantities.skin.rising_forms import rising_candidates, rising_form
from quantities.skin.yeung import yeung_form

_LARGEST_ERROR = {"red": 0.004, "green": 0.0006, "blue": 0.0002}


def _problem(reference: Reference) -> Problem:
    _, surface, channel = reference.name.split("-")

    def made(**shape):
        return hyperbola_form(reference, **shape)

    def rising(**shape):
        return rising_form(reference, **shape)

    return Problem(
        reference=reference,
        forms=(without_denominator(reference), pesce_form(reference), yeung_form(reference)),
        families={
            "hyperbola-skin": Family(made, ARGUMENTS),
            "rising-skin": Family(rising, ARGUMENTS),
        },
        candidates=lambda _: itertools.chain(candidates(reference), rising_candidates(reference)),
        calling=CallingConvention(
            name=f"Skin{surface.capitalize()}{channel.capitalize()}",
            summary=f"D, {channel} light that skin scatters on a {surface}; clamps to the domain.",
            arguments=(
                Argument("cosine", "NdotL", clamp="both", local="NdotL"),
                Argument("curvature", "curvature", clamp="both", local="curvature"),
            ),
            remark="NdotL = n·l is not clamped to 0; curvature is 1/r in 1/mm",
            codomain=(0.0, 1.0),
        ),
        plot=PlotHints(
            {
                "cosine": AxisHint("$n·l$", -1.0, 1.0, 0.0),
                "curvature": AxisHint("κ in mm⁻¹", 0.0, 0.5, 0.1),
            },
            values=(0.0, 1.0),
            largest_error=_LARGEST_ERROR[channel],
            against="cosine",
        ),
        topic="skin",
    )


SKIN_QUANTITIES = tuple(_problem(each) for each in SKIN_REFERENCES)
