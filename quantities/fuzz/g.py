"""The quantity G: the average over lights of what the layer scatters to the view."""

import integrals
from fitting.proofs.rounding_error import TracedArguments
from integrals.fuzz.g import ambient_scattering
from programs.functions import Function, Parameter, function
from quantities.calling_convention import Argument, CallingConvention, clamped
from quantities.family import Family
from quantities.fuzz.g_forms import AXES, DECAYS, FACTORS, RATES, candidates, decay_g, tied_g
from quantities.fuzz.supplement import RATIONAL_G
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import ExactCode, Problem

# The closed form takes logarithms of the density. The code clamps it to this at least; for a layer
# so thin, G is at most a thousandth (in half precision a sixteenth) at the least v·n of the domain.
_LEAST_DENSITY = {"half": 2.0**-14, "float": 1e-6, "double": 1e-6}
_CLOSED_FORM = (
    "closed form: x = density/NdotV; "
    "K = ln(1 + 1/NdotV) + E1(density + x) − exp(−x)·E1(density); "
    "G = 1 − exp(−x)·E2(density) − NdotV·K, where En(x) is the exponential integral "
    "∫ exp(−x·t)/tⁿ dt over t ≥ 1"
)
# From this density on, the layer is opaque: exp(−d) is below the rounding of float64.
_OPAQUE = 64.0


def exact_functions(precision: str) -> tuple[Function, ...]:
    """Return the closed form as a function of v·n and the density."""

    def value(cos_v, density):
        layer = clamped(density, _LEAST_DENSITY[precision], _OPAQUE)
        value = ambient_scattering(layer, clamped(cos_v, AXES[1].lower, 1.0))
        return clamped(value, 0.0, 1.0)

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
        summary="G ({equation}); clamps to the domain, and density to 0 from below.",
        arguments=(
            Argument("cos_v", "NdotV", clamp="both", local="NdotV"),
            # At d = 0, G is 0 for every ν > 0: a material without a layer stays as it is, at its
            # silhouette too. The forms tend to this value, so density is not clamped to 0.001.
            Argument("density", "density", clamp="both", local="density", least=0.0),
        ),
        remark="NdotV = v·n of the view's direction v; G = 0 at density = 0",
    ),
    closed_form=ambient_scattering,
    exact_code=ExactCode(
        _CLOSED_FORM,
        AXES,
        exact_functions,
        lambda points: (points[:, ::-1],),
        "NdotV = v·n of the view's direction v; clamps NdotV to the domain",
        traced=TracedArguments(AXES, lambda d, nu: (nu, d), (False, False)),
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
