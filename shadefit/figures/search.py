"""The frontier of a search: operations against the largest error of every form that was tried."""

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from integrals import INTEGRALS
from shadefit.figures.style import COLOURS, MARKERS, render

QUIET = "#aaaaaa"


def draw(quantity: str, found, best, published, exact) -> dict[str, bytes]:
    """Draw what a search found; returns the files by extension.

    `published`, and each of `found`, `best` and `exact`, the closed form if there is one, has
    `operations` and a `largest` error.
    """
    return render(lambda: _figure(quantity, found, best, published, exact))


def _figure(quantity: str, found, best, published, exact) -> Figure:
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.subplots()
    every = [*found, published, *exact]
    axes.plot(*_columns(found), ".", color=QUIET, label="forms tried", zorder=1)
    axes.step(*_columns(best), where="post", color=COLOURS["best"], lw=1, zorder=2)
    for marks, kind, label in (
        (best, "best", "frontier"),
        ([published], "published", "published"),
        (exact, "exact", "closed form in float32"),
    ):
        if not marks:
            continue
        colour, shape = COLOURS[kind], MARKERS[kind]
        axes.scatter(*_columns(marks), s=28, color=colour, marker=shape, label=label, zorder=3)
    costs = [each.operations for each in every]
    wide = max(costs) > 4 * min(costs)
    axes.set(xscale="log" if wide else "linear", yscale="log")
    axes.xaxis.set_major_formatter(ScalarFormatter())
    if max(costs) < 10 * min(costs):
        # Within a decade the minor ticks are the ones with labels.
        axes.xaxis.set_minor_formatter(ScalarFormatter())
    if not wide:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel="operations", ylabel="largest error", title=f"${INTEGRALS[quantity].symbol}$")
    axes.grid(color="#e5e5e5", lw=0.6)
    axes.set_axisbelow(True)
    axes.legend()
    return figure


def _columns(marks) -> tuple[list[int], list[float]]:
    return [mark.operations for mark in marks], [mark.largest for mark in marks]
