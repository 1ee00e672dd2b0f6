"""The picture of one fit: the exact values, the form, and its error."""

import numpy as np
from matplotlib.figure import Figure

from fitting import FittedForm, form_values
from quantities import Problem
from quantities.plot_hints import AxisHint
from shadefit.figures.style import COLOURS, ERRORS, VALUES
from shadefit.figures.values import axis_hints, math_symbol, mesh, points_along

_NODES, _MAP_NODES = 401, 101


def draw_result(owner: Problem, fitted: FittedForm) -> Figure:
    """Draw a form over its one or two axes. Of more axes, the others are at their middles.

    Of data, the data's own points are drawn.
    """
    pairs = axis_hints(owner)
    data = owner.reference.data
    if len(pairs) == 1:
        return _curve(owner, fitted, pairs[0][1])
    if data is not None:
        return _scattered(owner, fitted)
    shown = [hint for _, hint in pairs]
    lines = [points_along(h, _MAP_NODES, logarithmic=h.logarithmic) for h in shown[:2]]
    fixed = [np.array([(hint.lower + hint.upper) / 2]) for hint in shown[2:]]
    points = mesh(*lines, *fixed).reshape(-1, len(pairs))
    shape = (len(lines[0]), len(lines[1]))
    exact = owner.reference.values(points).reshape(shape)
    error = form_values(fitted, points).reshape(shape) - exact
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    largest = float(np.abs(error).max()) or 1.0
    grids = [line * hint.factor for line, hint in zip(lines, shown, strict=False)]
    pictures = (
        (left, exact, f"exact {math_symbol(owner)}", {"cmap": VALUES}),
        (right, error, "form − exact", {"cmap": ERRORS, "vmin": -largest, "vmax": largest}),
    )
    for axes, values, title, options in pictures:
        drawn = axes.pcolormesh(*grids, values.T, shading="gouraud", rasterized=True, **options)
        axes.set(title=title, xlabel=shown[0].shown_label)
        figure.colorbar(drawn, ax=axes, location="bottom", aspect=30)
    left.set(ylabel=shown[1].shown_label)
    return figure


def draw_data(owner: Problem) -> Figure:
    """Draw the values of data over their first one or two axes."""
    data, hints = owner.reference.data, [hint for _, hint in axis_hints(owner)]
    assert data is not None
    figure = Figure(figsize=(5.6, 3.8), layout="constrained")
    axes = figure.subplots()
    x = data.points[:, 0] * hints[0].factor
    if len(hints) == 1:
        axes.scatter(x, data.values, s=12, color=COLOURS["exact"])
        axes.set(xlabel=hints[0].shown_label, ylabel=math_symbol(owner))
        return figure
    y = data.points[:, 1] * hints[1].factor
    drawn = axes.scatter(x, y, c=data.values, s=12, cmap=VALUES)
    axes.set(xlabel=hints[0].shown_label, ylabel=hints[1].shown_label)
    figure.colorbar(drawn, ax=axes, label=math_symbol(owner))
    return figure


def _curve(owner: Problem, fitted: FittedForm, hint: AxisHint) -> Figure:
    figure = Figure(figsize=(5.6, 5.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    line = points_along(hint, _NODES, logarithmic=hint.logarithmic)
    data, values = owner.reference.data, form_values(fitted, line[:, None])
    above.plot(line * hint.factor, values, color=COLOURS["refitted"], label=fitted.form.name)
    if data is None:
        truth = owner.reference.values(line[:, None])
        above.plot(line * hint.factor, truth, color=COLOURS["exact"], label="exact", lw=0.9)
        below.plot(line * hint.factor, values - truth, color=COLOURS["refitted"])
    else:
        for rows, label, filled in (
            (data.fitted, "data, fitted", COLOURS["exact"]),
            (np.flatnonzero(data.held_out), "data, held out", "none"),
        ):
            x, y = data.points[rows], data.values[rows]
            style = {"s": 12, "facecolors": filled, "edgecolors": COLOURS["exact"]}
            above.scatter(x[:, 0] * hint.factor, y, label=label if len(rows) else None, **style)
            if len(rows):
                below.scatter(x[:, 0] * hint.factor, form_values(fitted, x) - y, **style)
    below.axhline(0, color=COLOURS["exact"], lw=0.8)
    above.set(ylabel=math_symbol(owner))
    above.legend()
    below.set(xlabel=hint.shown_label, ylabel="form − exact" if data is None else "form − data")
    if hint.logarithmic:
        below.set(xscale="log")
    return figure


def _scattered(owner: Problem, fitted: FittedForm) -> Figure:
    data, (first, second) = owner.reference.data, [hint for _, hint in axis_hints(owner)[:2]]
    assert data is not None
    error = form_values(fitted, data.points) - data.values
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    largest = float(np.abs(error).max()) or 1.0
    pictures = (
        (left, data.values, f"data, {math_symbol(owner)}", {"cmap": VALUES}),
        (right, error, "form − data", {"cmap": ERRORS, "vmin": -largest, "vmax": largest}),
    )
    x, y = data.points[:, 0] * first.factor, data.points[:, 1] * second.factor
    for axes, values, title, options in pictures:
        drawn = axes.scatter(x, y, c=values, s=12, **options)
        axes.set(title=title, xlabel=first.shown_label)
        figure.colorbar(drawn, ax=axes, location="bottom", aspect=30)
    left.set(ylabel=second.shown_label)
    return figure
