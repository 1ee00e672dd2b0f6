"""The picture of a search: operations against the largest error of every form that was tried."""

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from coefficients.search import Found, Result
from quantities import Problem
from shadefit.figures.style import COLOURS, MARKERS, render
from shadefit.figures.values import math_symbol

_OTHERS = "#aaaaaa"


def draw(owner: Problem, result: Result) -> dict[str, bytes]:
    """Draw what a search found; returns the files by extension."""
    return render(lambda: _figure(owner, result))


def _figure(owner: Problem, result: Result) -> Figure:
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.subplots()
    published = [] if result.published is None else [result.published]
    axes.plot(*_columns(result.found), ".", color=_OTHERS, label="forms tried", zorder=1)
    axes.step(*_columns(result.best), where="post", color=COLOURS["best"], lw=1, zorder=2)
    for marks, kind, label in (
        (result.best, "best", "frontier"),
        (published, "published", "published"),
        (result.exact, "exact", "closed form in float32"),
    ):
        if not marks:
            continue
        colour, shape = COLOURS[kind], MARKERS[kind]
        axes.scatter(*_columns(marks), s=28, color=colour, marker=shape, label=label, zorder=3)
    costs = [each.operations for each in (*result.found, *published, *result.exact)]
    wide = max(costs) > 4 * min(costs)
    axes.set(xscale="log" if wide else "linear", yscale="log")
    axes.xaxis.set_major_formatter(ScalarFormatter())
    if max(costs) < 10 * min(costs):
        # On less than a decade there are hardly any major ticks: label the minor ones too.
        axes.xaxis.set_minor_formatter(ScalarFormatter())
    if not wide:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel="operations", ylabel="largest error", title=math_symbol(owner))
    axes.grid(color="#e5e5e5", lw=0.6)
    axes.set_axisbelow(True)
    axes.legend()
    return figure


def _columns(marks: Sequence[Found]) -> tuple[list[int], list[float]]:
    return [mark.operations for mark in marks], [mark.largest for mark in marks]
