"""Pictures of a quantity of one axis: curves of its values, and of the errors of its tables."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coefficients.catalogue import entries
from coefficients.exported_code import exported_values
from quantities import Problem
from shadefit.figures.style import COLOURS, DASHES
from shadefit.figures.values import (
    axis_hints,
    exact,
    hints_of,
    kind_label,
    math_symbol,
    points_along,
)

_NODES = 201
# The free part above the largest value, as a fraction of the range of the values.
_HEADROOM = 0.03
# The least error that the logarithmic panel shows: the rounding of float64.
_LEAST = 1e-16
# The height of a name in the logarithmic panel, as a fraction of the panel.
_NAME = 0.06


def draw_curves(owner: Problem) -> Figure:
    """Draw a quantity of one axis, exact and by every table, and below the tables' errors.

    The errors are drawn twice: signed, and absolute on a logarithmic axis. Without tables only the
    exact values are drawn.
    """
    hints, tables = hints_of(owner), entries(owner)
    ((_, hint),) = axis_hints(owner)
    figure = Figure(figsize=(6.4, 7.4 if tables else 3.4), layout="constrained")
    panels = figure.subplots(
        3 if tables else 1,
        sharex=True,
        squeeze=False,
        height_ratios=(4, 3, 5) if tables else None,
    )[:, 0]
    line = points_along(hint, _NODES, logarithmic=hint.logarithmic)
    points = line[:, None]
    shown = line * hint.factor
    truth = exact(owner.reference, points)
    panels[0].plot(shown, truth, color=COLOURS["exact"], label=hints.exact_label)
    drawn: set[str] = set()
    ends = {}
    for entry in tables:
        kind = entry.kind
        label = None if kind in drawn else kind_label(kind, owner)
        drawn.add(kind)
        values = exported_values(entry, points)
        error = values - truth
        for axes, curve in zip(panels, (values, error, np.abs(error)), strict=True):
            axes.plot(
                shown,
                curve,
                label=label,
                color=COLOURS[kind],
                linestyle=DASHES[kind],
                # There may be many best tables: they are thin, and below the two compared ones.
                linewidth=0.9 if kind == "best" else 1.6,
                zorder=1 if kind == "best" else 2,
            )
        if kind == "best":
            ends[entry.name] = max(float(np.abs(error).max()), _LEAST)
    panels[0].set(ylabel=hints.value_label or math_symbol(owner))
    if hints.values is not None:
        low, high = hints.values
        panels[0].set(ylim=(low, high + _HEADROOM * (high - low)))
    panels[0].legend()
    panels[-1].set(xlabel=hint.shown_label, xlim=(shown[0], shown[-1]))
    if hint.logarithmic:
        panels[-1].set(xscale="log")
    if tables:
        panels[1].axhline(0, color=COLOURS["exact"], lw=0.8)
        panels[1].set(ylabel="table − exact")
        _finish_logarithmic(panels[2], ends)
    return figure


def _finish_logarithmic(axes: Axes, largest: dict[str, float]) -> None:
    """Scale the panel of absolute errors, and write the best tables' names at its right side.

    `largest` maps the name of a table to its largest error. The name stands at that height, or
    higher if a name below it is too near.
    """
    peaks = [float(np.nanmax(line.get_ydata(orig=True))) for line in axes.get_lines()]
    low, high = (10.0 ** np.floor(np.log10(max(x, _LEAST))) for x in (min(peaks), max(peaks)))
    # One decade or two below the least curve: curves go down to zero where an error changes sign.
    axes.set(ylabel="|table − exact|", yscale="log", ylim=(low / 10, high * 10))
    axes.grid(axis="y", color="#e5e5e5", lw=0.6)
    axes.set_axisbelow(True)
    height = -np.inf
    step = _NAME * np.log10(100 * high / low)
    for name, error in sorted(largest.items(), key=lambda pair: pair[1]):
        height = max(float(np.log10(error)), height + step)
        axes.annotate(
            name,
            (1.0, 10**height),
            xycoords=("axes fraction", "data"),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
            color=COLOURS["best"],
        )
