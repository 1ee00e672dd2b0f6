"""The frontier: the cost of an evaluation against its largest error, for every table."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from coefficients.catalogue import resolve
from coefficients.frontier import Mark, best_so_far, marks
from quantities import Problem, problems
from shadefit.figures.style import COLOURS, KINDS, MARKERS
from shadefit.figures.values import error_text, hints_of, math_symbol

_GGX = "microfacet"
# The tables of these are few and of one form each: README lists them.
_LISTED = ("maps", "skin")
# The marker of the published table is large and hollow, so that a refit at the same place is seen
# inside it.
_SIZES = {"exact": 110, "published": 90}
# A closed form of over _FAR times the operations of every table is not drawn. The axis of
# operations is logarithmic if their ratio is above _WIDE.
_FAR, _WIDE = 3, 12
# Left, bottom, right and top, in points.
_Box = tuple[float, float, float, float]
# The width of a letter of a label, in points.
_LETTER = 4.3
# Where a label may stand relative to its mark, in points: to the right (negative: to the left),
# and up. The nearest places come first.
_OFFSETS = tuple(
    (side * aside, up)
    for aside, ups in (
        (6.0, (2.0, -11.0, -4.5, 14.0, -23.0)),
        (14.0, (10.0, -19.0, -4.5)),
        (24.0, (18.0, -27.0, 6.0, -15.0)),
        (36.0, (26.0, -35.0, -4.5, 12.0, -21.0)),
        (50.0, (34.0, -43.0, -4.5)),
    )
    for up in ups
    for side in (1, -1)
)


def drawn_quantities(ggx: bool) -> list[Problem]:
    """List the quantities that have a panel: those with two marks or more to compare.

    They are those of GGX, or all others but those of maps and skin.
    """
    owners = [
        owner
        for owner in problems().values()
        if (owner.topic == _GGX) == ggx and owner.topic not in _LISTED
    ]
    return [owner for owner in owners if len(marks(owner)) > 1]


def draw_frontier(ggx: bool = False) -> Figure:
    """Draw the largest error of every table against its operations, one panel per quantity.

    The quantities are those of `drawn_quantities`.
    A closed form that costs far more than every table is written below the panel, because it would
    squeeze the tables.
    """
    drawn = drawn_quantities(ggx)
    rows = -(-len(drawn) // 2)
    figure = Figure(figsize=(9.6, 4.1 * rows + 0.4), layout="constrained")
    panels = figure.subplots(rows, 2, squeeze=False).ravel()
    shown = {owner: near(marks(owner)) for owner in drawn}
    for axes, owner in zip(panels, drawn, strict=False):
        _panel(axes, owner, shown[owner])
    for axes in panels[len(drawn) :]:
        axes.set_visible(False)
    handles = [
        Line2D(
            *([], []),
            color=COLOURS[kind],
            marker=MARKERS[kind],
            markerfacecolor="none" if kind == "published" else COLOURS[kind],
            linestyle="",
            label=label,
        )
        for kind, label in KINDS.items()
        if any(mark.kind == kind for every in shown.values() for mark in every)
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    # The labels are placed last, because they avoid everything else.
    figure.draw_without_rendering()
    for axes, owner in zip(panels, drawn, strict=False):
        _label(axes, owner, shown[owner], figure.dpi / 72)
    return figure


def near(every: Sequence[Mark]) -> tuple[Mark, ...]:
    """Return the marks without a closed form that costs over `_FAR` times as much as any table."""
    tables = [mark.operations for mark in every if mark.kind != "exact"]
    limit = _FAR * max(tables, default=math.inf)
    return tuple(mark for mark in every if mark.kind != "exact" or mark.operations <= limit)


def _panel(axes: Axes, owner: Problem, every: tuple[Mark, ...]) -> None:
    best = best_so_far(every)
    axes.step(
        [mark.operations for mark in best],
        [mark.largest for mark in best],
        where="post",
        color="#999999",
        lw=1,
        zorder=1,
    )
    for mark in every:
        axes.scatter(
            mark.operations,
            mark.largest,
            s=_SIZES.get(mark.kind, 36),
            edgecolors=COLOURS[mark.kind],
            facecolors="none" if mark.kind == "published" else COLOURS[mark.kind],
            marker=MARKERS[mark.kind],
            zorder=3,
        )
    label = hints_of(owner).cost_label
    for mark in marks(owner):
        if mark not in every:
            error = error_text(mark.largest)
            label += f"\n(★ {mark.name}: {mark.operations:,} operations, error {error})"
    axes.set(yscale="log", title=math_symbol(owner), xlabel=label, ylabel="largest error")
    axes.margins(x=0.12, y=0.1)
    costs = [mark.operations for mark in every]
    if max(costs) > _WIDE * min(costs):
        axes.set(xscale="log")
    else:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(color="#e5e5e5", lw=0.6)
    axes.set_axisbelow(True)


def _label(axes: Axes, owner: Problem, every: tuple[Mark, ...], dots: float) -> None:
    """Write the names of best tables beside their marks; `dots` is the pixels of a point.

    A name is placed where it covers nothing else. If it stands far from its mark, a thin line
    connects them. If there is no such place, the name is left out.
    """
    places = [(mark.operations, mark.largest) for mark in every]
    spots = (axes.transData.transform(places) / dots).tolist()
    low, high = (axes.bbox.get_points() / dots).tolist()
    taken = [_box(*spot, 8.0, 8.0, -4.0, -4.0) for spot in spots]
    for mark, (x, y) in zip(every, spots, strict=True):
        if mark.kind not in ("best", "exact"):
            continue
        text = mark.name if mark.kind == "exact" else label_of_mark(mark, owner)
        width = _LETTER * len(text)
        for aside, up in _OFFSETS:
            right = aside if aside > 0 else aside - width
            box = _box(x, y, width, 9.0, float(right), up)
            if box[0] < low[0] or box[1] < low[1] or box[2] > high[0] or box[3] > high[1]:
                continue
            if any(_overlap(box, other) for other in taken):
                continue
            far = _gap(box, (x, y)) > 8
            others = [spot for spot in spots if spot != [x, y]]
            if _misread(box, (x, y), others, far):
                continue
            taken.append(box)
            axes.annotate(
                text,
                (mark.operations, mark.largest),
                xytext=(aside, up + 2),
                textcoords="offset points",
                ha="left" if aside > 0 else "right",
                fontsize=7.5,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.75},
                arrowprops={"arrowstyle": "-", "lw": 0.5, "color": "#777777"} if far else None,
            )
            break


def label_of_mark(mark: Mark, owner: Problem) -> str:
    """Return the name of a best table, and that of its form without the quantity's name."""
    form = resolve(mark.name).require_table().form.removesuffix(f"-{owner.name}")
    return f"{mark.name.removeprefix('best/')}, {form}"


def _box(x: float, y: float, width: float, height: float, right: float, up: float) -> _Box:
    return (x + right, y + up, x + right + width, y + up + height)


def _misread(box: _Box, own: tuple[float, float], others: list[list[float]], far: bool) -> bool:
    """Return whether a label seems to belong to another mark than its `own`.

    This is so if another mark is nearer, or lies on the line between the label and its mark.
    """
    if not far:
        return any(_gap(box, other) < _gap(box, own) + 2 for other in others)
    end = [min(max(x, low), high) for x, low, high in zip(own, box[:2], box[2:], strict=True)]
    # The quarter of the line next to its own mark is left out; 4.5 is half the width of a mark.
    way = np.linspace(own, end, 40)[10:]
    return any(np.hypot(*(way - other).T).min() < 4.5 for other in others)


def _gap(box: _Box, spot: Sequence[float]) -> float:
    """Return the distance between a box and a place."""
    aside = max(box[0] - spot[0], 0.0, spot[0] - box[2])
    return math.hypot(aside, max(box[1] - spot[1], 0.0, spot[1] - box[3]))


def _overlap(one: _Box, other: _Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
