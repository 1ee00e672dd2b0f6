"""The picture that `shadefit render` draws: images and their differences."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from shadefit.figures.style import ERRORS, render
from shadefit.figures.values import round_up
from shadefit.render.comparison import Comparison
from shadefit.render.srgb import to_srgb

# Width and height of one image on the sheet.
_INCHES = 2.0
# The colour scale ends at this quantile of the absolute differences.
_QUANTILE = 0.995


def draw_comparisons(comparisons: list[Comparison]) -> bytes:
    """Return a PNG with one row for each scene.

    A row has the exact image, the image of each set of tables, and the differences of the latter
    from the exact one.
    """
    return render(lambda: _draw(comparisons))["png"]


def _draw(comparisons: list[Comparison]) -> Figure:
    names = list(comparisons[0].tables)
    columns = 1 + 2 * len(names)
    figure = Figure(
        figsize=(_INCHES * columns + 0.9, (_INCHES + 0.2) * len(comparisons) + 0.25),
        layout="constrained",
    )
    axes = figure.subplots(len(comparisons), columns, squeeze=False)
    limit = round_up(max(_high_quantile(c.difference(name)) for c in comparisons for name in names))
    shown = None
    for row, each in zip(axes, comparisons, strict=True):
        for axis, pixels in zip(row, (each.exact, *each.tables.values()), strict=False):
            axis.imshow(to_srgb(pixels))
        for axis, name in zip(row[1 + len(names) :], names, strict=True):
            shown = axis.imshow(each.difference(name), cmap=ERRORS, vmin=-limit, vmax=limit)
    titles = ["exact", *names, *(f"{name} − exact" for name in names)]
    for axis, title in zip(axes[0], titles, strict=True):
        axis.set_title(title)
    # All differences have one colour scale, on which small ones are invisible: print them too.
    for row, each in zip(axes, comparisons, strict=True):
        for axis, name in zip(row[1 + len(names) :], names, strict=True):
            off = np.abs(each.difference(name))
            rms = float(np.sqrt(np.mean(off**2)))
            axis.set_xlabel(f"rms {rms:.1e}, largest {off.max():.1e}", fontsize=8)
    for axis in axes.ravel():
        axis.set(xticks=[], yticks=[])
        axis.spines[:].set_visible(False)
    assert shown is not None
    bar: dict[str, Any] = {"ticks": (-limit, 0, limit), "extend": "both", "aspect": 30}
    figure.colorbar(shown, ax=axes, label="difference of linear luminance", **bar)
    return figure


def _high_quantile(difference: np.ndarray) -> float:
    return float(np.quantile(np.abs(difference), _QUANTILE))
