"""The quantity G: the average over lights of what the layer scatters to the view."""

import integrals
from integrals.fuzz.g import ambient_scattering
from programs.functions import Function, Parameter, function
from quantities.calling_convention import Argument, CallingConvention
from quantities.family import Family
from quantities.fuzz.g_forms import AXES, DECAYS, FACTORS, RATES, candidates, decay_g, tied_g
from quantities.fuzz.supplement import RATIONAL_G
from quantities.problem import AxisHint, ExactCode, PlotHints, Problem


def exact_functions(_: str) -> tuple[Function, ...]:
    """Return the closed form as a function of v·n and the density."""

    def value(cos_v, density):
        return ambient_scattering(density, cos_v)

    parameters = (
        Parameter("NdotV", (AXES[1].lower, AXES[1].upper)),
        Parameter("density", (AXES[0].lower, AXES[0].upper)),
    )
    summary = "G in closed form, without coefficients."
    return (function("FuzzGExact", parameters, value, summary),)


G = Problem(
    reference=integrals.G,
    forms=(RATIONAL_G,),
    families={
        "decay-g": Family(
            decay_g, {"decay": DECAYS, "rate": tuple(RATES), "factor": tuple(FACTORS)}
        ),
        "tied-g": Family(tied_g, {"poles": range(2), "root": range(2)}),
    },
    candidates=lambda _: candidates(),
    calling=CallingConvention(
        name="FuzzGApprox",
        summary="G ({equation}); clamps density from above.",
        arguments=(
            Argument("cos_v", "NdotV"),
            Argument("density", "density", clamp="above", local="density"),
        ),
        remark="NdotV = v·n of the view's direction v; density = NdotV = 0 is 0/0",
    ),
    closed_form=ambient_scattering,
    exact_code=ExactCode(
        "closed form, by exponential integrals",
        AXES,
        exact_functions,
        lambda points: (points[:, ::-1],),
        "NdotV = v·n of the view's direction v; the result is NaN if NdotV or density is 0",
    ),
    plot=PlotHints(
        {
            "density": AxisHint(
                "density $d$", 0.001, 0.5, 0.2, explored=(0.001, 1.0), logarithmic=True
            ),
            "cos_v": AxisHint("$v·n$", 0.001, 1.0, 0.5, logarithmic=True),
        },
        values=(0.0, 1.0),
        largest_error=0.1,
        azimuth=50.0,
        surface_nodes=61,
        map_nodes=121,
    ),
    topic="fuzz",
)
