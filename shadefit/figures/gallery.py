"""All pictures by name: those of each topic, one of each other quantity, and the frontier."""

from functools import partial

from quantities import Problem, problems
from quantities.skin import BAND_QUANTITIES, LOBE_QUANTITIES, SKIN_QUANTITIES
from shadefit.figures.curves import draw_curves
from shadefit.figures.detail_maps import detail_pictures
from shadefit.figures.encodings import encoding_pictures
from shadefit.figures.frontier import draw_frontier
from shadefit.figures.fuzz_pictures import DRAWN, fuzz_pictures
from shadefit.figures.maps import draw_errors
from shadefit.figures.maps_pictures import maps_pictures
from shadefit.figures.microfacet_pictures import microfacet_pictures
from shadefit.figures.microfacet_sampling import sampling_pictures
from shadefit.figures.ndf import ndf_pictures
from shadefit.figures.picture import Picture
from shadefit.figures.result import draw_data
from shadefit.figures.skin_surfaces import skin_pictures
from shadefit.figures.skin_tables import skin_table_pictures

_DRAW = {1: draw_curves, 2: draw_errors}

_FRONTIER = Picture(
    "Cost against error",
    "The largest error of every table against the operations of its exported function (for P_s, of "
    "the function of a direction). Errors are measured on the domain of the published table "
    "(α ≥ 0.15 for P_s and R); 'shadefit list' gives the error of a -wide table on its own domain. "
    "The error of the closed form is that of its evaluation in float32; where it costs far more "
    "than every table, it is below the panel. After the name of a table comes that of its form. "
    "The grey steps join the tables that no other table beats in both cost and error.",
    draw_frontier,
)

_GGX_FRONTIER = Picture(
    "Cost against error: GGX",
    "The same as the picture before it, for the quantities of GGX: E, A, B and E_avg.",
    partial(draw_frontier, ggx=True),
)


def pictures() -> dict[str, Picture]:
    """Return all pictures, by name.

    A quantity whose pictures are not declared gets errors-NAME if it has one or two axes. The
    quantities of skin look alike: only the first gets one.
    """
    shown = (*DRAWN, *SKIN_QUANTITIES[1:], *LOBE_QUANTITIES, *BAND_QUANTITIES)
    others = {
        f"errors-{owner.name}": errors_picture(owner)
        for owner in problems().values()
        if owner not in shown and len(owner.axes) in _DRAW
    }
    topics = {
        **fuzz_pictures(),
        **microfacet_pictures(),
        **sampling_pictures(),
        **ndf_pictures(),
        **encoding_pictures(),
        **detail_pictures(),
        **maps_pictures(),
        **skin_pictures(),
        **skin_table_pictures(),
    }
    return {**topics, **others, "frontier": _FRONTIER, "ggx-frontier": _GGX_FRONTIER}


def errors_picture(owner: Problem) -> Picture:
    """Return the picture of a quantity's values and of the errors of the tables that are kept.

    Of data, the values alone are drawn: tables have no errors between them.
    """
    if owner.reference.data is not None:
        caption = f"{owner.description}: the values of {owner.reference.data.source}."
        return Picture(f"Values of {owner.symbol}", caption, partial(draw_data, owner))
    draw = _DRAW[len(owner.axes)]
    caption = f"{owner.description}: the exact values, and the signed errors of its tables."
    return Picture(f"Errors of {owner.symbol}", caption, partial(draw, owner))
