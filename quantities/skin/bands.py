"""The quantities z₁ and z₂: what skin leaves of each band of light in spherical harmonics."""

import functools
from collections.abc import Iterator
from dataclasses import replace

from fitting.form import Form
from fitting.shapes.rationals import polynomial, rational
from integrals.reference import Reference, restricted
from integrals.skin.band_references import SKIN_BANDS as REFERENCES
from quantities.calling_convention import Argument, CallingConvention
from quantities.family import Family
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import Problem
from quantities.skin.hyperbola_forms import MOST_CURVATURE

MOST_TERMS = 4
# Terms of N and D that reach an error of 5e-4 or less
CHOSEN = {"red": (2, 2), "green": (1, 1), "blue": (1, 1)}


def _square(curvature):
    return curvature * curvature


@functools.cache
def band_form(reference: Reference, *, above: int, below: int) -> Form:
    """Return z = 1 + κ² (a₀ + …)/(1 + b₁κ² + …), of powers of κ², for κ ≤ 0.5 mm⁻¹."""
    form = rational(
        reference,
        range(above),
        range(below + 1),
        name="quotient-skin",
        axes=restricted(reference.axes, curvature=(0.0, MOST_CURVATURE)),
        of=_square,
        times=_square,
        plus=lambda: 1.0,
    )
    return replace(form, shape={"above": above, "below": below})


def _quartic(reference: Reference) -> Form:
    """Return z = 1 + κ² (c₀ + c₁κ²), whose least squares fit is a linear problem."""
    return polynomial(
        reference,
        1,
        name="quartic-skin",
        axes=restricted(reference.axes, curvature=(0.0, MOST_CURVATURE)),
        of=_square,
        times=_square,
        plus=lambda: 1.0,
    )


def _candidates(reference: Reference) -> Iterator[Form]:
    for above in range(1, MOST_TERMS):
        for below in (above - 1, above):
            yield band_form(reference, above=above, below=below)


def _problem(reference: Reference) -> Problem:
    _, _, band, channel = reference.name.split("-")

    def made(**shape):
        return band_form(reference, **shape)

    return Problem(
        reference=reference,
        forms=(_quartic(reference),),
        families={
            "quotient-skin": Family(
                made, {"above": range(1, MOST_TERMS + 1), "below": range(MOST_TERMS + 1)}
            )
        },
        candidates=lambda _: _candidates(reference),
        calling=CallingConvention(
            name=f"SkinBand{band}{channel.capitalize()}",
            summary=f"z{band}: factor of band {band} of {channel} light in spherical harmonics "
            "that skin scatters; clamps to the domain.",
            arguments=(Argument("curvature", "curvature", clamp="both", local="curvature"),),
            remark="curvature is 1/r in 1/mm; the factor of band 0 is 1",
            codomain=(0.0, 1.0),
        ),
        plot=PlotHints(
            {"curvature": AxisHint("κ in mm⁻¹", 0.0, MOST_CURVATURE, 0.1)},
            values=(0.0, 1.0),
            largest_error=5e-4,
        ),
        topic="skin",
    )


BAND_QUANTITIES = tuple(_problem(each) for each in REFERENCES)
