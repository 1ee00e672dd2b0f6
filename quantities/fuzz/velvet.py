"""The quantity r(k): the largest factor of the velvet phase function that creates no energy."""

import integrals
from fitting.proofs.rounding_error import TracedArguments
from integrals.fuzz.velvet import normalisation
from programs.functions import Function, Parameter, function
from quantities.calling_convention import Argument, CallingConvention, clamped
from quantities.fuzz.velvet_form import AXES, CONSERVATIVE_NORM
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import ExactCode, Problem

_CLOSED_FORM = (
    "closed form: x = −asymmetry; s = √(1 − x²); A = π + 2·asin(x); "
    "r = (π/2)·x²·s/(A·(2·x² − 1) + 2·x·s + π·s³), where x > 0; by a power series for small x"
)
_REMARK = "asymmetry is k of Schlick's lobe p_Schlick(k, -sin(t, h)), whose factor r is"


def exact_functions(_: str) -> tuple[Function, ...]:
    """Return the closed form as a function of the asymmetry."""

    def value(asymmetry):
        return normalisation(clamped(asymmetry, -1.0, 0.0))

    parameters = (Parameter("asymmetry", (AXES[0].lower, AXES[0].upper)),)
    summary = "r(k) in closed form, without coefficients."
    return (function("FuzzVelvetNormExact", parameters, value, summary),)


VELVET = Problem(
    reference=integrals.VELVET,
    forms=(CONSERVATIVE_NORM,),
    calling=CallingConvention(
        name="FuzzVelvetNorm",
        summary="r(k), which scales the velvet phase function, from below; clamps to the domain.",
        arguments=(Argument("asymmetry", "asymmetry", clamp="both"),),
        remark=_REMARK,
    ),
    closed_form=normalisation,
    exact_code=ExactCode(
        _CLOSED_FORM,
        AXES,
        exact_functions,
        lambda points: (points,),
        _REMARK,
        traced=TracedArguments(AXES, lambda k: (k,), (False,)),
    ),
    plot=PlotHints(
        {"asymmetry": AxisHint("asymmetry $k$", -0.95, 0.0, -0.5)},
        values=(0.0, 1.0),
        largest_error=1e-3,
    ),
    topic="fuzz",
)
