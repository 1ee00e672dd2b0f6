"""The frontier: what an evaluation costs against how wrong it is, for every table there is."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coefficients.catalogue import form_of, load
from coefficients.compare import compare
from coefficients.cost import count
from coefficients.shaders import exact_ps, shader
from fitting import off_grid_reference
from integrals import INTEGRALS
from integrals.g import ambient_scattering
from integrals.q import average_penetration
from programs.function import Function, Parameter, function
from programs.program import evaluate
from programs.trace import trace
from shadefit.figures.style import COLOURS, KINDS, MARKERS
from shadefit.figures.values import kind_of, quantities, tables_of

_DENSITY, _COS_V = Parameter("density", (0.0, 0.5)), Parameter("NdotV", (0.001, 1.0))
# The published table is a frame: a refit in the same place is seen inside it.
_SIZES = {"exact": 110, "published": 90}
_Box = tuple[float, float, float, float]
# The width of a letter of a label, in points.
_LETTER = 4.3
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
    """Name the frontier's other forms, each where there is room; `dots` are those of a point."""
    places = [(mark.operations, mark.largest) for mark in every]
    spots = (axes.transData.transform(places) / dots).tolist()
    taken = [_box(*spot, 8.0, 8.0, -4.0, -4.0) for spot in spots]
    for mark in best_so_far(every):
        if mark.kind != "best":
            continue
        x, y = spots[every.index(mark)]
        text = mark.name.removeprefix("best/")
        for right, up in ((True, True), (False, False), (True, False), (False, True)):
            width = _LETTER * len(text)
            box = _box(x, y, width, 9.0, 6.0 if right else -6.0 - width, 2.0 if up else -11.0)
            if any(_overlap(box, other) for other in taken):
                continue
            taken.append(box)
            axes.annotate(
                text,
                (mark.operations, mark.largest),
                xytext=(6 if right else -6, 4 if up else -9),
                textcoords="offset points",
                ha="left" if right else "right",
                fontsize=7.5,
            )
            break


def _box(x: float, y: float, width: float, height: float, right: float, up: float) -> _Box:
    return (x + right, y + up, x + right + width, y + up + height)


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
