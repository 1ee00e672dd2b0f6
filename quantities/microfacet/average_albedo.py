"""The quantity E_avg: the average albedo of GGX."""

from integrals.microfacet.references import GGX_AVERAGE_ALBEDO as REFERENCE
from quantities.family import Family
from quantities.microfacet.average_forms import (
    CUBIC,
    MOST_TERMS,
    STRUCTURES,
    average_form,
    candidates,
)
from quantities.microfacet.shader import ALPHA_HINT, calling
from quantities.plot_hints import PlotHints
from quantities.problem import Problem

GGX_AVERAGE_ALBEDO = Problem(
    reference=REFERENCE,
    forms=(CUBIC,),
    families={
        "quotient-ggx-average-albedo": Family(
            average_form,
            {
                "structure": STRUCTURES,
                "above": range(1, MOST_TERMS + 1),
                "below": range(MOST_TERMS + 1),
            },
        ),
    },
    candidates=lambda _: candidates(),
    calling=calling(
        "GgxAverageAlbedo", "E_avg, the cosine-weighted average of the albedo of GGX", of_view=False
    ),
    plot=PlotHints({"alpha": ALPHA_HINT}, values=(0.0, 1.0), largest_error=1e-3),
    topic="microfacet",
)
