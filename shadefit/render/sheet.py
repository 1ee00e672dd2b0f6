"""The picture that `shadefit render` draws: a large image, and differences of the others."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from shadefit.figures.style import ERRORS, render
from shadefit.figures.values import error_text, round_up
from shadefit.render.comparison import Comparison
from shadefit.render.srgb import to_srgb

# The factor that makes differences visible.
FACTOR = 50
# Edges of the large image and of a small one, the space between columns and between rows, and the
# space on the left and above, in inches.
_LARGE, _SMALL, _ASIDE, _APART, _LEFT, _ABOVE = 6.0, 1.46, 0.12, 0.26, 0.06, 0.3
# The colour scale ends at this quantile of the absolute differences.
_QUANTILE = 0.995
# The box behind a text on an image.
_LABEL = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5}


def draw_comparisons(comparisons: list[Comparison], large: np.ndarray) -> bytes:
    """Return a PNG with a large exact image (h, w, 3), and a column for each scene beside it.

    A column has the exact image, and the difference of the image of each set of tables from it.
    """
    return render(lambda: _draw(comparisons, large), ["png"])["png"]


def _draw(comparisons: list[Comparison], large: np.ndarray) -> Figure:
    names = list(comparisons[0].tables)
    high = (1 + len(names)) * (_SMALL + _APART)
    width = _LEFT + _LARGE + 0.3 + len(comparisons) * (_SMALL + _ASIDE)
    height = _ABOVE + max(high, _LARGE + 0.75)
    figure = Figure(figsize=(width, height))

    def add(left: float, top: float, wide: float, tall: float) -> Axes:
        """Add axes at a distance from the left and from the top, in inches."""
        place = (left / width, 1 - (top + tall) / height, wide / width, tall / height)
        return figure.add_axes(place)

    limit = round_up(max(_high_quantile(c.difference(name)) for c in comparisons for name in names))
    end = FACTOR * limit
    hero = add(_LEFT, _ABOVE, _LARGE, _LARGE)
    hero.imshow(to_srgb(large))
    hero.set_title(f"{comparisons[-1].scene.name}, exact")
    for column, each in enumerate(comparisons):
        left = _LEFT + _LARGE + 0.3 + column * (_SMALL + _ASIDE)
        cells = [
            add(left, _ABOVE + row * (_SMALL + _APART), _SMALL, _SMALL)
            for row in range(1 + len(names))
        ]
        cells[0].imshow(to_srgb(each.exact))
        cells[0].set_title(f"{each.scene.name}, exact")
        for axes, name in zip(cells[1:], names, strict=True):
            off = each.difference(name)
            axes.imshow(FACTOR * off, cmap=ERRORS, vmin=-end, vmax=end)
            axes.set_title(f"({name} − exact) × {FACTOR}", fontsize=8.5, pad=3)
            text = f"largest {error_text(np.abs(off).max())}"
            axes.text(0.03, 0.03, text, transform=axes.transAxes, fontsize=7.5, bbox=_LABEL)
    for axes in figure.axes:
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
    bar = add(_LEFT + 1.2, _ABOVE + _LARGE + 0.22, _LARGE - 2.4, 0.12)
    ends = ScalarMappable(Normalize(-end, end), ERRORS)
    options: dict[str, Any] = {"orientation": "horizontal", "extend": "both", "format": "{x:g}"}
    options |= {"ticks": (-end, 0, end)}
    label = f"difference of linear luminance × {FACTOR}"
    figure.colorbar(ends, cax=bar, label=label, **options)
    return figure


def _high_quantile(difference: np.ndarray) -> float:
    return float(np.quantile(np.abs(difference), _QUANTILE))
