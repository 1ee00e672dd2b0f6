"""The quantities w and w₁: how much wider than α² + v the best lobe of spread normals is."""

from integrals.maps.references import SGGX_FILTER as FILTER
from integrals.maps.references import SGGX_FILTER_AXES as FILTER_AXES
from quantities.calling_convention import Argument, CallingConvention
from quantities.family import Family
from quantities.maps.forms import (
    LINEAR,
    LINEAR_AXES,
    MOST_TERMS,
    axes_candidates,
    axes_form,
    candidates,
    filter_form,
)
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import Problem

SGGX_FILTER = Problem(
    reference=FILTER,
    forms=(LINEAR,),
    families={
        "quotient-sggx-filter": Family(
            filter_form, {"above": range(1, MOST_TERMS + 1), "below": range(MOST_TERMS + 1)}
        )
    },
    candidates=lambda _: candidates(),
    calling=CallingConvention(
        name="SggxFilter",
        summary="w: alpha'^2 = (alpha^2 + v) w is the squared width of the best GGX lobe "
        "({equation}); clamps to the domain.",
        arguments=(Argument("share", "share", clamp="both", local="share"),),
        remark="share = v/(alpha^2 + v), with the variance v of the slopes of the normals",
    ),
    plot=PlotHints(
        {"share": AxisHint("$v/(α^2 + v)$", 0.0, 1.0, 0.5)}, values=(1.0, 2.0), largest_error=0.02
    ),
    topic="maps",
)
SGGX_FILTER_AXES = Problem(
    reference=FILTER_AXES,
    forms=(LINEAR_AXES,),
    families={
        "quotient-sggx-filter-axes": Family(
            axes_form, {"numerator": "exponents", "denominator": "exponents or none"}
        )
    },
    candidates=lambda _: axes_candidates(),
    calling=CallingConvention(
        name="SggxFilterAxes",
        summary="w1: alpha1'^2 = (alpha1^2 + v1) w1 is the squared width along an axis "
        "({equation}); clamps to the domain.",
        arguments=(
            Argument("along", "shareAlong", clamp="both", local="along"),
            Argument("across", "shareAcross", clamp="both", local="across"),
        ),
        remark="the shares are v/(alpha^2 + v) along the axis and across it; for the other axis "
        "exchange them",
    ),
    plot=PlotHints(
        {
            "along": AxisHint("$u_1$", 0.0, 1.0, 0.5),
            "across": AxisHint("$u_2$", 0.0, 1.0, 0.5),
        },
        values=(1.0, 2.0),
        largest_error=0.02,
        azimuth=50.0,
        surface_nodes=61,
        map_nodes=121,
    ),
    topic="maps",
)
