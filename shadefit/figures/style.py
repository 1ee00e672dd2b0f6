"""One style for every picture, whose colours can be told apart by the colour-blind and in print."""

import io
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from PIL import Image

FORMATS = ("png", "svg")
VALUES = "viridis"
ERRORS = "PuOr"
FIBRE = "#d55e00"
# Dots per inch of raster parts: all of a PNG, and images and dense surfaces in an SVG.
_DPI = {"png": 120, "svg": 72}

_STYLE: dict[Any, Any] = {
    "axes.grid": False,
    "axes.labelsize": 9,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9.5,
    "figure.facecolor": "white",
    "font.size": 9,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "mathtext.fontset": "dejavusans",
    "svg.hashsalt": "shadefit",
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
}

# The kinds of tables (the keys below are the same), and what legends call them.
KINDS = {
    "printed": "published, as printed",
    "published": "published",
    "refitted": "refitted, same form",
    "best": "best, other forms",
    "exact": "closed form, in float32",
}
# Each kind has a colour of Okabe and Ito, a dash pattern and a marker, so that no two kinds differ
# by colour alone.
COLOURS = {
    "exact": "#000000",
    "published": "#d55e00",
    "printed": "#cc79a7",
    "refitted": "#0072b2",
    "best": "#009e73",
}
DASHES = {
    "exact": "-",
    "published": (0, (5, 2)),
    "printed": (0, (5, 1.5, 1, 1.5)),
    "refitted": (0, (1.5, 1.5)),
    "best": (0, (8, 2, 2, 2)),
}
MARKERS = {"exact": "*", "published": "s", "printed": "X", "refitted": "o", "best": "D"}


def render(draw: Callable[[], Figure], formats: Sequence[str] = FORMATS) -> dict[str, bytes]:
    """Draw a figure in this style. Returns its files by extension, the same bytes each time.

    `formats` are the extensions, in the order of `FORMATS`.

    The user's settings of Matplotlib, such as a file `matplotlibrc` in the current folder, do not
    count.
    """
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        figure = draw()
        return {extension: _encode(figure, extension) for extension in formats}


def _encode(figure: Figure, extension: str) -> bytes:
    buffer = io.BytesIO()
    metadata = {"Date": None} if extension == "svg" else {"Software": None}
    figure.savefig(buffer, format=extension, dpi=_DPI[extension], metadata=metadata)
    return buffer.getvalue() if extension == "svg" else _smaller(buffer)


def _smaller(png: io.BytesIO) -> bytes:
    """Remove the alpha channel, which is opaque everywhere, and compress as far as possible."""
    buffer = io.BytesIO()
    Image.open(png).convert("RGB").save(buffer, "png", optimize=True)
    return buffer.getvalue()


def space(figure: Figure, place: tuple[float, float, float, float]) -> Axes3D:
    """Add three-dimensional axes to a figure.

    `place` is left, bottom, width and height as fractions of the figure.
    """
    axes = figure.add_axes(place, projection="3d", computed_zorder=False)
    assert isinstance(axes, Axes3D)
    # The axes reach beyond their place. A transparent background does not cover the neighbours.
    axes.patch.set_visible(False)
    return axes
