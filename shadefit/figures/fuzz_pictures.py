"""The pictures of the fuzz BRDF: the seven figures of the supplement, and errors of its tables."""

from functools import partial

from quantities.fuzz import PS, VELVET, G, Q, R
from shadefit.figures.curves import draw_curves
from shadefit.figures.maps import draw_errors, draw_surfaces
from shadefit.figures.picture import Picture
from shadefit.figures.ps_lights import draw_discs, draw_spherical
from shadefit.figures.ps_materials import draw_ps_errors, draw_rows

# The quantities whose pictures are declared here. r(k) has none.
DRAWN = (PS, G, Q, R, VELVET)


def fuzz_pictures() -> dict[str, Picture]:
    """Return the pictures of the fuzz BRDF, by name."""
    return {
        "ps": Picture(
            "P_s and its errors, from above",
            "P_s over the hemisphere of lights, seen from above. The fibre leans to the right. "
            "From left to right: the exact values, the published table (its two rows exchanged), "
            "the refitted table, and the signed errors of both tables.",
            draw_discs,
        ),
        "figure-1": _spherical(1, 0.15),
        "figure-2": _spherical(2, 0.35),
        "figure-3": _spherical(3, 0.55),
        "figure-4": _spherical(4, 0.75),
        "figure-5": Picture(
            "Figure 5 of the supplement: G and G̃",
            "G over the density and v·n: exact, by the published table, and by the refitted one.",
            partial(draw_surfaces, G),
        ),
        "figure-6": Picture(
            "Figure 6 of the supplement: Q and Q̃",
            "Q over the density, exact and by every table. Below: the signed errors of the tables.",
            partial(draw_curves, Q),
        ),
        "figure-7": Picture(
            "Figure 7 of the supplement: R and R̃",
            "R over α and the fibre's angle: exact, by the published table, and by the refitted "
            "one.",
            partial(draw_surfaces, R),
        ),
        "errors-ps": Picture(
            "Errors of P_s by material",
            "The rms and the largest error of P_s over all lights, for every material: the "
            "published table as printed, the published table with its two rows exchanged, and "
            "the refitted table.",
            draw_ps_errors,
        ),
        "errors-g": Picture(
            "Errors of G",
            "G and the signed errors of its tables on logarithmic axes. The errors are largest "
            "where the layer is thin and the view is grazing. The error is zero along the grey "
            "lines.",
            partial(draw_errors, G),
        ),
        "errors-r": Picture(
            "Errors of R",
            "R and the signed errors of its tables over materials. The error is zero along the "
            "grey lines.",
            partial(draw_errors, R),
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


def _spherical(number: int, alpha: float) -> Picture:
    return Picture(
        f"Figure {number} of the supplement: P_s and P̃_s, α = {alpha:g}",
        f"P_s over the hemisphere of lights for α = {alpha:g}, as a spherical plot: the distance "
        "of the surface from the centre is P_s. The circles have the radii ½ and 1. The orange "
        "line is the fibre. The colours are lightly shaded. The tables are evaluated as in the "
        "listings, which clamp θf to 0.1; this changes the first column.",
        partial(draw_spherical, alpha),
    )
