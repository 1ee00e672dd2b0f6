"""Pictures of a quantity of two axes: surfaces, and maps of the signed errors of its tables."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from coefficients.catalogue import resolve
from coefficients.exported_code import operations_of
from quantities import Problem
from shadefit.figures.style import ERRORS, VALUES, space
from shadefit.figures.values import (
    axis_hints,
    best_tables,
    compared_tables,
    compared_values,
    error_text,
    hints_of,
    label_of,
    math_symbol,
    mesh,
    points_along,
    round_up,
)

# The width of the whole page of error maps, and the height of a row, in inches.
_WIDTH, _HEIGHT = 9.6, 2.7
# The ends of the colour scales of errors, times a power of ten.
_STEPS = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


def draw_surfaces(owner: Problem, names: Sequence[str]) -> Figure:
    """Draw a quantity over its two axes, in their own units: exact, and by the named tables."""
    hints, pairs = hints_of(owner), axis_hints(owner)
    points = mesh(*(points_along(hint, hints.surface_nodes) for _, hint in pairs))
    values = compared_values(owner, points, map(resolve, names))
    bounds = hints.values or _range(values["exact"])
    figure = Figure(figsize=(9.6, 3.6))
    for column, (title, heights) in enumerate(values.items()):
        place = (0.025 + 0.325 * column, 0.19, 0.31, 0.8)
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
    figure.colorbar(scale, cax=bar, orientation="horizontal", label=math_symbol(owner))
    return figure


def draw_errors(owner: Problem) -> Figure:
    """Map a quantity of two axes, and the signed errors of its tables.

    The errors of each table have a colour scale of their own. Tables that are not kept are left
    out; without any, only the exact values are drawn.
    """
    hints, pairs = hints_of(owner), axis_hints(owner)
    first, second = (hint for _, hint in pairs)
    points = mesh(
        *(points_along(h, hints.map_nodes, logarithmic=h.logarithmic) for h in (first, second))
    )
    tables = [*compared_tables(owner), *best_tables(owner)]
    truth, *columns = compared_values(owner, points, tables).values()
    # Three or four columns, whichever leaves fewer places empty.
    wide = min(1 + len(tables), min((3, 4), key=lambda n: -(1 + len(tables)) % n))
    high = -(-(1 + len(tables)) // wide)
    width = _WIDTH * min(wide, 3) / 3
    figure = Figure(figsize=(width, _HEIGHT * high), layout="constrained")
    grid = figure.subplots(high, wide, sharex=True, sharey=True, squeeze=False)
    panels = grid.ravel()
    x, y = points[..., 0] * first.factor, points[..., 1] * second.factor
    # Scales come first: contours put their labels where there is room.
    if first.logarithmic:
        panels[0].set(xscale="log")
    if second.logarithmic:
        panels[0].set(yscale="log")
    shown = panels[0].pcolormesh(x, y, truth, cmap=VALUES, rasterized=True, shading="gouraud")
    if np.ptp(truth) > 0:
        lines = panels[0].contour(x, y, truth, levels=8, colors="white", linewidths=0.7)
        panels[0].clabel(lines, fontsize=7.5)
    panels[0].set_title("exact\n")
    figure.colorbar(shown, ax=panels[0], label=math_symbol(owner), aspect=25)
    for axes, table, values in zip(panels[1:], tables, columns, strict=False):
        signed = values - truth
        worst = float(np.abs(signed).max())
        _error_map(figure, axes, x, y, signed)
        facts = (f"{operations_of(table)} operations", f"largest {error_text(worst)}")
        lines = (f"{label_of(table)} − exact", *(facts if wide == 4 else (", ".join(facts),)))
        axes.set_title("\n".join(lines))
    for axes in panels[1 + len(tables) :]:
        axes.set_visible(False)
    for row in range(high):
        grid[row, 0].set_ylabel(second.shown_label)
    for column in range(wide):
        # The lowest panel of a column that is drawn.
        low = max(row for row in range(high) if row * wide + column <= len(tables))
        grid[low, column].set_xlabel(first.shown_label)
        grid[low, column].tick_params(labelbottom=True)
    return figure


def _error_map(figure: Figure, axes: Axes, x: np.ndarray, y: np.ndarray, signed: np.ndarray):
    """Map signed errors on a colour scale that ends a little above the largest."""
    limit = round_up(float(np.abs(signed).max()), _STEPS)
    shown = axes.pcolormesh(
        x, y, signed, cmap=ERRORS, vmin=-limit, vmax=limit, rasterized=True, shading="gouraud"
    )
    if signed.min() < 0 < signed.max():
        axes.contour(x, y, signed, levels=[0], colors="#555555", linewidths=0.7)
    figure.colorbar(shown, ax=axes, ticks=(-limit, 0, limit), format="{x:g}", aspect=25)


def _own_label(label: str, unit: str) -> str:
    """Return the label of an axis whose values are shown in its own unit."""
    return label if unit == "1" else f"{label} / {unit}"


def _range(values: np.ndarray) -> tuple[float, float]:
    return float(values.min()), float(values.max())
