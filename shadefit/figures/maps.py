"""Pictures of a quantity of two arguments: surfaces, and maps of its tables' signed errors."""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from integrals import Integral
from shadefit.figures.style import ERRORS, VALUES, space
from shadefit.figures.values import exact, exported


def surfaces(
    integral: Integral,
    points: np.ndarray,
    labels: tuple[str, str, str],
    bounds: tuple[float, float],
    azimuth: float,
) -> Figure:
    """Draw a quantity over two arguments as surfaces: exact, published and refitted.

    Arguments: `points` (n, m, 2), its arguments; `labels` of both and of the quantity; `bounds`
    of the quantity; `azimuth` in degrees, where the surface is seen from.
    """
    figure = Figure(figsize=(9.6, 3.6))
    values = _columns(integral, points)
    for column, (title, heights) in enumerate(values.items()):
        place = (0.005 + 0.325 * column, 0.19, 0.31, 0.8)
        axes = space(figure, place)
        axes.plot_surface(
            points[..., 0],
            points[..., 1],
            heights,
            facecolors=colormaps[VALUES](Normalize(*bounds)(heights)),
            shade=False,
            rstride=1,
            cstride=1,
            linewidth=0,
            antialiased=False,
        ).set_rasterized(True)
        # A few lines across it give the surface its shape.
        axes.plot_wireframe(
            points[..., 0], points[..., 1], heights, rcount=7, ccount=7, color="#00000066", lw=0.5
        )
        axes.set(xlabel=labels[0], ylabel=labels[1], zlim=bounds)
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
            axis.set_major_locator(MaxNLocator(4))
        axes.tick_params(pad=0)
        axes.view_init(elev=25, azim=azimuth)
        axes.set_box_aspect((1, 1, 0.75), zoom=0.92)
        axes.set_title(title, y=0.97)
    bar = figure.add_axes((0.35, 0.13, 0.3, 0.025))
    scale = ScalarMappable(Normalize(*bounds), VALUES)
    figure.colorbar(scale, cax=bar, orientation="horizontal", label=labels[2])
    return figure


def error_maps(
    integral: Integral,
    points: np.ndarray,
    labels: tuple[str, str],
    largest: float,
    logarithmic: bool = False,
    units: tuple[float, float] = (1.0, 1.0),
) -> Figure:
    """Map a quantity of two arguments, and the signed errors of the published and refitted table.

    Arguments as for `surfaces`; errors beyond ±`largest` are shown as if they were that; `units`,
    what the arguments are multiplied by to be shown.
    """
    values = _columns(integral, points)
    figure = Figure(figsize=(9.6, 3.5), layout="constrained")
    grid = figure.subplots(1, 3, sharey=True)
    truth = values.pop("exact")
    x, y = points[..., 0] * units[0], points[..., 1] * units[1]
    if logarithmic:
        # Before anything is drawn: contours are labelled where there is room.
        grid[0].set(xscale="log", yscale="log")
    shown = grid[0].pcolormesh(x, y, truth, cmap=VALUES, rasterized=True, shading="gouraud")
    lines = grid[0].contour(x, y, truth, levels=8, colors="white", linewidths=0.7)
    grid[0].clabel(lines, fontsize=7.5)
    grid[0].set_title("exact")
    errors = shown
    for axes, (label, column) in zip(grid[1:], values.items(), strict=True):
        signed = column - truth
        errors = axes.pcolormesh(
            x,
            y,
            np.clip(signed, -largest, largest),
            cmap=ERRORS,
            vmin=-largest,
            vmax=largest,
            rasterized=True,
            shading="gouraud",
        )
        axes.contour(x, y, signed, levels=[0], colors="#555555", linewidths=0.7)
        worst = np.abs(signed).max()
        axes.set_title(f"{label} − exact (up to {worst:.2g} here)")
    for axes in grid:
        axes.set(xlabel=labels[0])
        if logarithmic:
            axes.set(xscale="log", yscale="log")
    grid[0].set_ylabel(labels[1])
    figure.colorbar(shown, ax=grid[0], location="bottom", label=f"${integral.symbol}$", aspect=30)
    figure.colorbar(
        errors,
        ax=grid[1:],
        location="bottom",
        label=f"error of ${integral.symbol}$",
        extend="both",
        aspect=50,
        ticks=[-largest, -largest / 2, 0, largest / 2, largest],
    )
    return figure


def _columns(integral: Integral, points: np.ndarray) -> dict[str, np.ndarray]:
    name = integral.name
    return {
        "exact": exact(integral, points),
        "published": exported(f"published/{name}", points),
        "refitted": exported(name, points),
    }
