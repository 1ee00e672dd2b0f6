"""A picture of a mesh as skin: N·L, a lookup table, a fit, their differences, and curvature."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from shadefit.curvature.meshes import Mesh
from shadefit.curvature.raster import rasterise
from shadefit.curvature.skin_light import ALBEDO, SHADERS, Skin
from shadefit.figures.style import ERRORS, render
from shadefit.figures.values import error_text, round_up
from shadefit.render.srgb import to_srgb

LAMBERT, TABLE, FIT = "N·L", "LUT, κ along the light", "fit, equivalent cylinder"
# Samples along an edge of a pixel, the part of the image that the mesh fills, the width of a panel
# in inches, and the quantile at which colour scales end
_SAMPLES, _FILLED, _PANEL, _QUANTILE = 2, 0.96, 3.2, 0.995
# The least and the largest ratio of height to width of a panel
_FLATTEST, _TALLEST = 0.4, 1.6


@dataclass(frozen=True)
class View:
    """Where the viewer and the light are: azimuths and heights in radians, and pixels.

    At azimuth 0 and height 0 the viewer is at +z, and y is up; a growing azimuth goes towards +x.
    Azimuth and height of the light are those from the viewer. `size` is the width of a panel.
    """

    azimuth: float
    height: float
    light_azimuth: float
    light_height: float
    size: int


def axes_of(azimuth: float, height: float) -> Float[np.ndarray, "3 3"]:
    """Return the unit vectors to the right, upwards and to the viewer, as rows."""
    out = _direction(azimuth, height)
    right = np.array([np.cos(azimuth), 0.0, -np.sin(azimuth)])
    return np.stack([right, np.cross(out, right), out])


def draw_mesh(mesh: Mesh, skin: Skin, view: View) -> bytes:
    """Return a PNG of a mesh whose vertices are skin, without shadows, by an orthographic view.

    The first row has N·L, the lookup table with the curvature along the light, and the fit with the
    equivalent cylinder. The second has the mean curvature, what the table adds to N·L in red, and
    what the fit adds to the table. Raises ValueError for a mesh without extent in the view.
    """
    axes = axes_of(view.azimuth, view.height)
    light = axes.T @ _direction(view.light_azimuth, view.light_height)
    seen = mesh.vertices @ axes.T
    low, high = seen[:, :2].min(0), seen[:, :2].max(0)
    extent = high - low
    if not extent.max() > 0:
        raise ValueError("the mesh is a point in this view: there is nothing to draw")
    ratio = np.clip(extent[1] / max(extent[0], 1e-9 * extent[1]), _FLATTEST, _TALLEST)
    wide = view.size * _SAMPLES
    tall = max(1, round(view.size * ratio)) * _SAMPLES
    scale = _FILLED * min(wide / max(extent[0], 1e-300), tall / max(extent[1], 1e-300))
    middle = (low + high) / 2
    pixels = np.column_stack(
        [
            wide / 2 + scale * (seen[:, 0] - middle[0]),
            tall / 2 - scale * (seen[:, 1] - middle[1]),
            seen[:, 2],
        ]
    )
    raster = rasterise(pixels, mesh.triangles, (tall, wide))
    points = skin.at(*raster.corners(mesh.triangles))
    images = {name: SHADERS[name](points, light) for name in (LAMBERT, TABLE, FIT)}
    bend = np.trace(points.tensors, axis1=1, axis2=2) / 2
    covered = raster.covered
    maps = {
        "mean curvature in 1/mm": bend,
        "LUT − N·L, red": (images[TABLE] - images[LAMBERT])[:, 0],
        "fit − LUT, red": (images[FIT] - images[TABLE])[:, 0],
    }

    def draw() -> Figure:
        figure = Figure(figsize=(3 * _PANEL, 2 * _PANEL * tall / wide + 1.2), layout="constrained")
        panels = figure.subplots(2, 3)
        for axes, (name, image) in zip(panels[0], images.items(), strict=True):
            linear = np.ones((tall, wide, 3))
            linear[covered] = to_srgb(ALBEDO * image)
            axes.imshow(_pixels(linear))
            axes.set_title(name)
        for axes, (name, values) in zip(panels[1], maps.items(), strict=True):
            _map(figure, axes, name, values, covered)
        for axes in panels.flat:
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(False)
        return figure

    return render(draw)["png"]


def _map(figure: Figure, axes: Axes, name: str, values: np.ndarray, covered: np.ndarray) -> None:
    """Draw signed values at the covered samples, with a colour scale of their own."""
    end = round_up(max(float(np.quantile(np.abs(values), _QUANTILE)) if len(values) else 0, 1e-9))
    whole = np.zeros(covered.shape)
    whole[covered] = values
    share = _pixels(covered.astype(float))
    mean = np.where(share > 0, _pixels(whole) / np.where(share > 0, share, 1.0), np.nan)
    shown = axes.imshow(mean, cmap=ERRORS, vmin=-end, vmax=end)
    largest = np.abs(values).max() if len(values) else 0.0
    axes.set_title(f"{name}\nlargest {error_text(largest)}")
    figure.colorbar(
        shown,
        ax=axes,
        orientation="horizontal",
        extend="both",
        ticks=(-end, 0, end),
        format="{x:g}",
        shrink=0.7,
    )


def _pixels(samples: np.ndarray) -> np.ndarray:
    """Return the means over the samples of each pixel."""
    tall, wide = samples.shape[0] // _SAMPLES, samples.shape[1] // _SAMPLES
    return samples.reshape(tall, _SAMPLES, wide, _SAMPLES, *samples.shape[2:]).mean((1, 3))


def _direction(azimuth: float, height: float) -> np.ndarray:
    flat = np.cos(height)
    return np.array([flat * np.sin(azimuth), np.sin(height), flat * np.cos(azimuth)])
