"""The pictures of the fuzz BRDF: the seven figures of the supplement, and errors of its tables."""

from functools import partial

from quantities.fuzz.g import G
from quantities.fuzz.ps import PS
from quantities.fuzz.q import Q
from quantities.fuzz.r import R
from quantities.fuzz.velvet import VELVET
from shadefit.figures.curves import draw_curves
from shadefit.figures.maps import draw_errors, draw_surfaces
from shadefit.figures.picture import Picture
from shadefit.figures.ps_lights import draw_discs, draw_spherical
from shadefit.figures.ps_materials import draw_ps_errors, draw_rows

# The quantities whose pictures are declared here.
DRAWN = (PS, G, Q, R, VELVET)


def fuzz_pictures() -> dict[str, Picture]:
    """Return the pictures of the fuzz BRDF, by name."""
    return {
        "ps": Picture(
            "P_s and its errors, from above",
            "P_s over the hemisphere of lights, seen from above. The orange line is the fibre. "
            "From left to right: the exact values, the published table (its two rows exchanged), a "
            "best "
            "table, and the signed errors of the published and two best tables. Each of these has "
            "a colour scale of its own: the same colour stands for an error that is 5 or 40 times "
            "smaller. The operations are those of a direction.",
            draw_discs,
        ),
        "figures-1-4": Picture(
            "Figures 1 to 4 of the supplement: P_s and P̃_s",
            "P_s over the hemisphere of lights, as a spherical plot: the distance of the surface "
            "from the centre is P_s. The circles have the radii ½ and 1. The orange line is the "
            "fibre. The colours are lightly shaded. The discs are the signed errors, seen from "
            "above, with the fibre to the right; the two tables have different colour scales. The "
            "published table is evaluated as in the listing, which clamps θf to 0.1; this changes "
            "the rows with θf = 0.",
            draw_spherical,
        ),
        "figure-5": Picture(
            "Figure 5 of the supplement: G and G̃",
            "G over the density and v·n: exact, by the published table, and by the best one.",
            partial(draw_surfaces, G, ("published/g", "best/g-17")),
        ),
        "figure-6": Picture(
            "Figure 6 of the supplement: Q and Q̃",
            "Q over the density, exact and by every table. Below: the signed errors of the tables, "
            "and the absolute errors on a logarithmic axis, where every table can be seen.",
            partial(draw_curves, Q),
        ),
        "figure-7": Picture(
            "Figure 7 of the supplement: R and R̃",
            "R over α and the fibre's angle: exact, by the published table, and by the best one.",
            partial(draw_surfaces, R, ("published/r", "best/r-45")),
        ),
        "errors-ps": Picture(
            "Errors of P_s by material",
            "The rms and the largest error of P_s over all lights, for every material: the "
            "published table as printed, the published table with its two rows exchanged, the "
            "refitted table, and two best tables. All have one logarithmic colour scale.",
            draw_ps_errors,
        ),
        "errors-g": Picture(
            "Errors of G",
            "G and the signed errors of all its tables on logarithmic axes. Each table has a "
            "colour scale of its own. The errors of the published table are largest where the "
            "layer is thin and the view is grazing. The error is zero along the grey lines.",
            partial(draw_errors, G),
        ),
        "errors-r": Picture(
            "Errors of R",
            "R and the signed errors of all its tables over materials. Each table has a colour "
            "scale of its own. The error is zero along the grey lines.",
            partial(draw_errors, R),
        ),
        "errors-velvet": Picture(
            "The normalisation of the velvet phase function",
            "r(k) over the asymmetry k, exact and by its table. Below: the error of the table, "
            "signed, and absolute on a logarithmic axis. It is nowhere positive, so that the table "
            "creates no energy.",
            partial(draw_curves, VELVET),
        ),
        "rows-ps": Picture(
            "The two exchanged rows of P_s",
            "The coefficients c₀ … c₅ of Eq. (1) over materials. First row: the best "
            "coefficients, fitted to each material by itself. Below: the published table as "
            "printed, the published table with c₃ and c₄ exchanged, and the refitted table. The "
            "frames mark the error: the printed c₃ looks like the best c₄, and the printed c₄ "
            "like the best c₃.",
            draw_rows,
        ),
    }
