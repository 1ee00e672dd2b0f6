"""Every picture that there is: its name, what it shows, and what draws it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from coefficients.files import require_writable, write_whole_bytes
from shadefit.figures.frontier import draw_frontier
from shadefit.figures.layer import draw_g, draw_g_errors, draw_q
from shadefit.figures.materials import draw_ps_errors, draw_r, draw_r_errors, draw_rows
from shadefit.figures.spherical import draw_discs, draw_spherical
from shadefit.figures.style import render


@dataclass(frozen=True)
class Picture:
    """A picture: a title, a caption that says all that it shows, and what draws it."""

    title: str
    caption: str
    draw: Callable[[], Figure]


def _spherical(number: int, alpha: float) -> Picture:
    return Picture(
        f"Figure {number} of the supplement: P_s and P̃_s, α = {alpha:g}",
        f"P_s over the hemisphere of lights for α = {alpha:g} as a spherical plot: the surface is "
        "as far from the centre as P_s is large, the circles have radius ½ and 1, the fibre is "
        "the orange line, colours are lightly shaded. The tables are evaluated as listed: θf is "
        "clamped to 0.1 in the first column.",
        partial(draw_spherical, alpha),
    )


PICTURES: dict[str, Picture] = {
    "ps": Picture(
        "P_s and its errors, from above",
        "P_s over the hemisphere of lights seen from above, the fibre leaning to the right: exact, "
        "published (rows exchanged), refitted, and the signed errors of both.",
        draw_discs,
    ),
    "figure-1": _spherical(1, 0.15),
    "figure-2": _spherical(2, 0.35),
    "figure-3": _spherical(3, 0.55),
    "figure-4": _spherical(4, 0.75),
    "figure-5": Picture(
        "Figure 5 of the supplement: G and G̃",
        "G over density and v·n: exact, published and refitted.",
        draw_g,
    ),
    "figure-6": Picture(
        "Figure 6 of the supplement: Q and Q̃",
        "Q over density, exact and by every table, and the signed errors of the tables.",
        draw_q,
    ),
    "figure-7": Picture(
        "Figure 7 of the supplement: R and R̃",
        "R over α and the fibre's angle: exact, published and refitted.",
        draw_r,
    ),
    "errors-ps": Picture(
        "Errors of P_s by material",
        "The rms and the largest error of P_s over lights for every material: the published table "
        "as printed, with its two rows exchanged, and the refitted one.",
        draw_ps_errors,
    ),
    "errors-g": Picture(
        "Errors of G",
        "G and the signed errors of its tables on logarithmic axes: the errors are largest where "
        "the layer is thin and the view grazes. Grey lines: no error.",
        draw_g_errors,
    ),
    "errors-r": Picture(
        "Errors of R",
        "R and the signed errors of its tables over materials. Grey lines: no error.",
        draw_r_errors,
    ),
    "rows-ps": Picture(
        "The two exchanged rows of P_s",
        "c₀ … c₅ of Eq. (1) over materials. Top: the best ones for each material by itself. Below: "
        "the published table as printed, with rows c₃ and c₄ (framed) exchanged, and the refit. As "
        "printed, c₃ looks as c₄ should and c₄ as c₃ should.",
        draw_rows,
    ),
    "frontier": Picture(
        "Cost against error",
        "The largest error of every table against the operations of its exported function (for P_s "
        "those of a direction), on the domain of the published one (α ≥ 0.15): 'shadefit list' "
        "gives the error of a -wide table over its own. The closed form is marked by its error in "
        "float32. A step joins what nothing beats in both.",
        draw_frontier,
    ),
}


def run(names: list[str], out: Path) -> None:
    """Draw pictures into a folder, all unless some are named; the same tables give the same bytes.

    Raises ValueError for a name that no picture has and a folder that cannot be written.
    """
    for name in names:
        if name not in PICTURES:
            raise ValueError(f"no figure is called {name!r}: allowed are {', '.join(PICTURES)}")
    require_writable(out)
    for name in names or PICTURES:
        for extension, data in render(PICTURES[name].draw).items():
            path = out / f"{name}.{extension}"
            write_whole_bytes(path, data)
            print(path)
