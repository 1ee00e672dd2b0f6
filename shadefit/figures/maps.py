"""Pictures of a quantity of two axes: surfaces, and maps of the signed errors of its tables."""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from quantities import Problem
from shadefit.figures.style import ERRORS, VALUES, space
from shadefit.figures.values import axis_hints, compared_values, hints_of, mesh, points_along


def draw_surfaces(owner: Problem) -> Figure:
    """Draw a quantity over its two axes, in their own units: exact, published and refitted."""
    hints, pairs = hints_of(owner), axis_hints(owner)
    points = mesh(*(points_along(hint, hints.surface_nodes) for _, hint in pairs))
    values = compared_values(owner, points)
    bounds = hints.values or _range(values["exact"])
    figure = Figure(figsize=(9.6, 3.6))
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
        # A few lines on the surface show its shape.
        axes.plot_wireframe(
            points[..., 0], points[..., 1], heights, rcount=7, ccount=7, color="#00000066", lw=0.5
        )
        labels = [_own_label(hint.short_label or hint.label, axis.unit) for axis, hint in pairs]
        axes.set(xlabel=labels[0], ylabel=labels[1], zlim=bounds)
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
            axis.set_major_locator(MaxNLocator(4))
        axes.tick_params(pad=0)
        axes.view_init(elev=25, azim=hints.azimuth)
        axes.set_box_aspect((1, 1, 0.75), zoom=0.92)
        axes.set_title(title, y=0.97)
    bar = figure.add_axes((0.35, 0.13, 0.3, 0.025))
    scale = ScalarMappable(Normalize(*bounds), VALUES)
    figure.colorbar(scale, cax=bar, orientation="horizontal", label=f"${owner.symbol}$")
    return figure


def draw_errors(owner: Problem) -> Figure:
    """Map a quantity of two axes, and the signed errors of its published and refitted table.

    Tables that are not kept are left out; without any, only the exact values are drawn.
    """
    hints, pairs = hints_of(owner), axis_hints(owner)
    first, second = (hint for _, hint in pairs)
    points = mesh(
        *(points_along(h, hints.map_nodes, logarithmic=h.logarithmic) for h in (first, second))
    )
    values = compared_values(owner, points)
    figure = Figure(figsize=(round(3.2 * len(values), 1), 3.5), layout="constrained")
    grid = figure.subplots(1, len(values), sharey=True, squeeze=False)[0]
    truth = values.pop("exact")
    x, y = points[..., 0] * first.factor, points[..., 1] * second.factor
    scales = {
        f"{name}scale": "log" for name, hint in (("x", first), ("y", second)) if hint.logarithmic
    }
    # Scales come first: contours put their labels where there is room.
    grid[0].set(**scales)
    shown = grid[0].pcolormesh(x, y, truth, cmap=VALUES, rasterized=True, shading="gouraud")
    if np.ptp(truth) > 0:
        lines = grid[0].contour(x, y, truth, levels=8, colors="white", linewidths=0.7)
        grid[0].clabel(lines, fontsize=7.5)
    grid[0].set_title("exact")
    errors = shown
    largest = hints.largest_error
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
        if signed.min() < 0 < signed.max():
            axes.contour(x, y, signed, levels=[0], colors="#555555", linewidths=0.7)
        worst = np.abs(signed).max()
        axes.set_title(f"{label} − exact (up to {worst:.2g} here)")
    for axes in grid:
        axes.set(xlabel=first.shown_label)
        axes.set(**scales)
    grid[0].set_ylabel(second.shown_label)
    figure.colorbar(shown, ax=grid[0], location="bottom", label=f"${owner.symbol}$", aspect=30)
    if values:
        figure.colorbar(
            errors,
            ax=grid[1:],
            location="bottom",
            label=f"error of ${owner.symbol}$",
            extend="both",
            aspect=50,
            ticks=[-largest, -largest / 2, 0, largest / 2, largest],
        )
    return figure


def _own_label(label: str, unit: str) -> str:
    """Return the label of an axis whose values are shown in its own unit."""
    return label if unit == "1" else f"{label} / {unit}"


def _range(values: np.ndarray) -> tuple[float, float]:
    return float(values.min()), float(values.max())
