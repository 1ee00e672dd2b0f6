"""The frontier: what an evaluation costs against how wrong it is, for every table there is."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from coefficients.shaders import exact_ps, shader
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coefficients.catalogue import form_of, load
from coefficients.compare import compare
from fitting import off_grid_reference
from integrals import INTEGRALS
from integrals.fuzz.g import ambient_scattering
from integrals.fuzz.q import average_penetration
from programs.cost import count
from programs.functions import Function, Parameter, function
from programs.program import evaluate
from programs.tracing.tracer import trace
from shadefit.figures.style import COLOURS, KINDS, MARKERS
from shadefit.figures.values import kind_of, quantities, tables_of

_DENSITY, _COS_V = Parameter("density", (0.0, 0.5)), Parameter("NdotV", (0.001, 1.0))
# The published table is a frame: a refit in the same place is seen inside it.
_SIZES = {"exact": 110, "published": 90}
_Box = tuple[float, float, float, float]
# The width of a letter of a label, in points.
_LETTER = 4.3
# Where a label may stand: its side of the mark and how far aside, and how far up, in points.
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
_COUNTED = {"ps": "operations a direction"}


@dataclass(frozen=True)
class Mark:
    """One way to evaluate a quantity: what it is, operations, largest and rms error."""

    name: str
    kind: str
    operations: int
    largest: float
    rms: float


def draw_frontier() -> Figure:
    """Draw the largest error of every table against its operations, a panel a quantity."""
    figure = Figure(figsize=(9.6, 7.2), layout="constrained")
    drawn = quantities()
    panels = figure.subplots(-(-len(drawn) // 2), 2, sharex=True).ravel()
    for axes, quantity in zip(panels, drawn, strict=False):
        _panel(axes, quantity, marks(quantity))
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
        if any(mark.kind == kind for quantity in drawn for mark in marks(quantity))
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    # Labels look for room: first everything else has to be in its place.
    figure.draw_without_rendering()
    for axes, quantity in zip(panels, drawn, strict=False):
        _label(axes, marks(quantity), figure.dpi / 72)
    return figure


@lru_cache(maxsize=8)
def marks(quantity: str) -> tuple[Mark, ...]:
    """Give a mark for every named table of a quantity, and for its closed form where there is one.

    A table's errors are those of its float64 form, on the off-grid points of the published one; the
    closed form has only those of float32, in which it is evaluated on the same points. Operations
    are those of the last exported function: for P_s what a direction costs once the material is
    known.
    """
    names = tables_of(quantity)
    first = f"published/{quantity}"
    names.sort(key=lambda name: name != first)
    entries = compare([(name, load(name)) for name in names]).entries
    found = [
        Mark(
            entry.label,
            kind_of(entry.label),
            count(trace(shader(entry.label).functions[-1])).operations,
            entry.errors.largest,
            entry.errors.rms,
        )
        for entry in entries
    ]
    return (*found, *closed_form(quantity))


def closed_form(quantity: str) -> list[Mark]:
    """Give the mark of the closed form, evaluated in float32; none where there is no such form."""
    if quantity not in _EXACT:
        return []
    exact, columns = _EXACT[quantity]
    program = trace(exact)
    points, truth = off_grid_reference(type(form_of(load(f"published/{quantity}"))))
    rows = columns(points).astype(np.float32)
    error = np.abs(evaluate(program, rows, np.float32)[:, 0] - truth)
    rms = float(np.sqrt(np.mean(error**2)))
    return [Mark("closed form", "exact", count(program).operations, float(error.max()), rms)]


def best_so_far(every: Iterable[Any]) -> list[Any]:
    """Give those that no other one beats in both operations and largest error, by cost.

    Each has a `name`, `operations` and the `largest` error.
    """
    best = []
    for mark in sorted(every, key=lambda mark: (mark.operations, mark.largest, mark.name)):
        if not best or mark.largest < best[-1].largest:
            best.append(mark)
    return best


def _panel(axes: Axes, quantity: str, every: tuple[Mark, ...]) -> None:
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
    integral = INTEGRALS[quantity]
    errors = np.log10([mark.largest for mark in every])
    axes.set(yscale="log", xscale="log", title=f"${integral.symbol}$")
    axes.set(xlabel=_COUNTED.get(quantity, "operations"), ylabel="largest error")
    axes.set_ylim(10 ** np.floor(errors.min() - 0.3), 10 ** np.ceil(errors.max() + 0.3))
    axes.margins(x=0.1)
    axes.tick_params(labelbottom=True)
    axes.grid(color="#e5e5e5", lw=0.6)
    axes.set_axisbelow(True)


def _label(axes: Axes, every: tuple[Mark, ...], dots: float) -> None:
    """Name every other form, each where there is room; `dots` are those of a point.

    Where a mark's neighbours leave none, the name stands further off, at the end of a thin line.
    """
    places = [(mark.operations, mark.largest) for mark in every]
    spots = (axes.transData.transform(places) / dots).tolist()
    low, high = (axes.bbox.get_points() / dots).tolist()
    taken = [_box(*spot, 8.0, 8.0, -4.0, -4.0) for spot in spots]
    for mark, (x, y) in zip(every, spots, strict=True):
        if mark.kind != "best":
            continue
        text = mark.name.removeprefix("best/")
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
                arrowprops={"arrowstyle": "-", "lw": 0.5, "color": "#777777"} if far else None,
            )
            break


def _box(x: float, y: float, width: float, height: float, right: float, up: float) -> _Box:
    return (x + right, y + up, x + right + width, y + up + height)


def _misread(box: _Box, own: tuple[float, float], others: list[list[float]], far: bool) -> bool:
    """Tell whether a label seems to be another mark's: one is nearer, or on the line to its own."""
    if not far:
        return any(_gap(box, other) < _gap(box, own) + 2 for other in others)
    end = [min(max(x, low), high) for x, low, high in zip(own, box[:2], box[2:], strict=True)]
    # Of the line what is clear of its own mark, against half a mark's width.
    way = np.linspace(own, end, 40)[10:]
    return any(np.hypot(*(way - other).T).min() < 4.5 for other in others)


def _gap(box: _Box, spot: Sequence[float]) -> float:
    """Give how far a box is from a place."""
    aside = max(box[0] - spot[0], 0.0, spot[0] - box[2])
    return math.hypot(aside, max(box[1] - spot[1], 0.0, spot[1] - box[3]))


def _overlap(one: _Box, other: _Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def _exact_g() -> Function:
    def value(density, cos_v):
        return ambient_scattering(density, cos_v)

    return function("exactG", (_DENSITY, _COS_V), value)


def _exact_q() -> Function:
    return function("exactQ", (_DENSITY,), average_penetration)


_EXACT = {
    "ps": (exact_ps()[0], lambda points: shader("exact/ps").columns(points)[0]),
    "g": (_exact_g(), lambda points: points),
    "q": (_exact_q(), lambda points: points),
}
