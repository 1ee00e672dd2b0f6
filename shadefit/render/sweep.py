"""The talk's sweeps on one sheet: density, spread and tilt of the fibres."""

from dataclasses import replace
from itertools import product

import numpy as np
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from shadefit.figures.style import render
from shadefit.render.compare import Settings, image
from shadefit.render.images import srgb

DENSITIES = (0.1, 0.2)
SPREADS = (0.2, 0.5, 1.0)
TILTS = (0, 23, 45, 90)
_INCHES = 1.7


def draw_sweep(scene: str, settings: Settings) -> bytes:
    """Draw every combination with exact functions: rows are layers, columns tilts; as PNG."""
    layers = list(product(DENSITIES, SPREADS))
    images = {
        (layer, tilt): image(
            scene,
            replace(settings, density=layer[0], spread=layer[1], tilt=float(np.radians(tilt))),
            "exact",
        )
        for layer in layers
        for tilt in TILTS
    }

    def draw() -> Figure:
        size = (_INCHES * len(TILTS) + 0.3, _INCHES * len(layers) + 0.3)
        tight = ConstrainedLayoutEngine(w_pad=0.02, h_pad=0.02, wspace=0.01, hspace=0.01)
        figure = Figure(figsize=size, layout=tight)
        axes = figure.subplots(len(layers), len(TILTS))
        for row, layer in zip(axes, layers, strict=True):
            row[0].set_ylabel(f"density {layer[0]:g}, spread {layer[1]:g}")
            for axis, tilt in zip(row, TILTS, strict=True):
                axis.imshow(srgb(images[layer, tilt]))
                axis.set(xticks=[], yticks=[])
                axis.spines[:].set_visible(False)
        for axis, tilt in zip(axes[0], TILTS, strict=True):
            axis.set_title(f"tilt {tilt}°")
        return figure

    return render(draw)["png"]
