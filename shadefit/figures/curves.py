"""Pictures of a quantity of one axis: curves of its values, and of the errors of its tables."""

from matplotlib.figure import Figure

from coefficients.catalogue import entries
from coefficients.exported_code import exported_values
from quantities import Problem
from shadefit.figures.style import COLOURS, DASHES, KINDS
from shadefit.figures.values import axis_hints, exact, hints_of, points_along

_NODES = 201
# The free part above the largest value, as a fraction of the range of the values.
_HEADROOM = 0.03


def draw_curves(owner: Problem) -> Figure:
    """Draw a quantity of one axis, exact and by every table, and below the tables' signed errors.

    Without tables only the exact values are drawn.
    """
    hints, tables = hints_of(owner), entries(owner)
    ((_, hint),) = axis_hints(owner)
    figure = Figure(figsize=(5.6, 5.0 if tables else 3.4), layout="constrained")
    if tables:
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    else:
        above = below = figure.subplots()
    line = points_along(hint, _NODES, logarithmic=hint.logarithmic)
    points = line[:, None]
    shown = line * hint.factor
    truth = exact(owner.reference, points)
    above.plot(shown, truth, color=COLOURS["exact"], label=hints.exact_label)
    if tables:
        below.axhline(0, color=COLOURS["exact"], lw=0.8)
    drawn: set[str] = set()
    for entry in tables:
        kind = entry.kind
        label = None if kind in drawn else KINDS[kind]
        drawn.add(kind)
        values = exported_values(entry, points)
        for axes, curve in ((above, values), (below, values - truth)):
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
    above.set(ylabel=hints.value_label or f"${owner.symbol}$")
    if hints.values is not None:
        low, high = hints.values
        above.set(ylim=(low, high + _HEADROOM * (high - low)))
    above.legend()
    if tables:
        below.set(ylabel="table − exact")
    below.set(xlabel=hint.shown_label, xlim=(shown[0], shown[-1]))
    if hint.logarithmic:
        below.set(xscale="log")
    return figure
