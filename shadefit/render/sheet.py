"""The sheet of `shadefit render`: images and their differences, scene by scene."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from shadefit.figures.style import ERRORS, render
from shadefit.render.images import srgb

if TYPE_CHECKING:
    from shadefit.render.compare import Comparison

_INCHES = 2.0


def compare_sheet(comparisons: "list[Comparison]") -> bytes:
    """Draw one row a scene: exact, each table, and each table's difference from exact; as PNG."""
    return render(lambda: _draw(comparisons))["png"]


def _draw(comparisons: "list[Comparison]") -> Figure:
    names = list(comparisons[0].tables)
    columns = 1 + 2 * len(names)
    figure = Figure(
        figsize=(_INCHES * columns + 0.9, (_INCHES + 0.2) * len(comparisons) + 0.25),
        layout="constrained",
    )
    axes = figure.subplots(len(comparisons), columns, squeeze=False)
    limit = round_up(max(_extent(c.difference(name)) for c in comparisons for name in names))
    shown = None
    for row, each in zip(axes, comparisons, strict=True):
        for axis, pixels in zip(row, (each.exact, *each.tables.values()), strict=False):
            axis.imshow(srgb(pixels))
        for axis, name in zip(row[1 + len(names) :], names, strict=True):
            shown = axis.imshow(each.difference(name), cmap=ERRORS, vmin=-limit, vmax=limit)
    titles = ["exact", *names, *(f"{name} − exact" for name in names)]
    for axis, title in zip(axes[0], titles, strict=True):
        axis.set_title(title)
    # In words too: on one scale, differences far below the largest are not to be seen.
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


def _extent(difference: np.ndarray) -> float:
    return float(np.quantile(np.abs(difference), 0.995))


def round_up(value: float) -> float:
    """Give the next 1, 2 or 5 times a power of ten; 1e-9 for nothing."""
    if value <= 1e-9:
        return 1e-9
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(m * power for m in (1, 2, 5, 10) if m * power >= value))
