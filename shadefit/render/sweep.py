"""A picture of one scene for many densities, spreads and tilts, as the talk shows them."""

from dataclasses import replace
from itertools import product

import numpy as np
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from shadefit.figures.style import render
from shadefit.render.functions import EXACT
from shadefit.render.image import Progress, render_images, silent
from shadefit.render.scenes import Scene
from shadefit.render.settings import Settings
from shadefit.render.srgb import to_srgb

DENSITIES = (0.1, 0.2)
SPREADS = (0.2, 0.5, 1.0)
# In degrees.
TILTS = (0, 23, 45, 90)
# Width and height of one image on the sheet.
_INCHES = 1.7


def draw_sweep(scene: Scene, settings: Settings, progress: Progress = silent) -> bytes:
    """Return a PNG of every combination, drawn with exact functions.

    A row has one density and spread, a column has one tilt; they replace those of `settings`.
    """
    layers = list(product(DENSITIES, SPREADS))
    cells = list(product(layers, TILTS))
    wanted = [
        (replace(settings, density=density, spread=spread, tilt=float(np.radians(tilt))), EXACT)
        for (density, spread), tilt in cells
    ]
    images = dict(zip(cells, render_images(scene, wanted, progress), strict=True))

    def draw() -> Figure:
        size = (_INCHES * len(TILTS) + 0.3, _INCHES * len(layers) + 0.3)
        tight = ConstrainedLayoutEngine(w_pad=0.02, h_pad=0.02, wspace=0.01, hspace=0.01)
        figure = Figure(figsize=size, layout=tight)
        axes = figure.subplots(len(layers), len(TILTS))
        for row, layer in zip(axes, layers, strict=True):
            row[0].set_ylabel(f"density {layer[0]:g}, spread {layer[1]:g}")
            for axis, tilt in zip(row, TILTS, strict=True):
                axis.imshow(to_srgb(images[layer, tilt]))
                axis.set(xticks=[], yticks=[])
                axis.spines[:].set_visible(False)
        for axis, tilt in zip(axes[0], TILTS, strict=True):
            axis.set_title(f"tilt {tilt}°")
        return figure

    return render(draw, ["png"])["png"]
