"""The frontier: what an evaluation costs against how wrong it is, for every table there is."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coefficients.catalogue import load
from coefficients.compare import compare
from coefficients.cost import count
from coefficients.shaders import exact_ps, function, shader
from fitting import off_grid_reference
from integrals import INTEGRALS
from integrals.g import ambient_scattering
from integrals.q import average_penetration
from programs.function import Function, Parameter
from programs.program import evaluate
from programs.trace import trace
from shadefit.figures.style import COLOURS, MARKERS
from shadefit.figures.values import kind_of, quantities, tables_of

_DENSITY, _COS_V = Parameter("density", (0.0, 0.5)), Parameter("NdotV", (0.001, 1.0))
_KINDS = {
    "printed": "published, as printed",
    "published": "published",
    "refitted": "refitted, same form",
    "best": "other forms",
    "exact": "closed form, in float32",
}
# The published table is a frame: a refit in the same place is seen inside it.
_SIZES = {"exact": 110, "published": 90}
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
        for kind, label in _KINDS.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
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
    return (*found, *_closed_form(quantity))


def _closed_form(quantity: str) -> list[Mark]:
    if quantity not in _EXACT:
        return []
    exact, columns = _EXACT[quantity]
    program = trace(exact)
    points, truth = off_grid_reference(type(shader(f"published/{quantity}").form))
    rows = columns(points).astype(np.float32)
    error = np.abs(evaluate(program, rows, np.float32)[:, 0] - truth)
    rms = float(np.sqrt(np.mean(error**2)))
    return [Mark("closed form", "exact", count(program).operations, float(error.max()), rms)]


def best_so_far(every: tuple[Mark, ...]) -> list[Mark]:
    """Give the marks that no other one beats in both operations and largest error, by cost."""
    best: list[Mark] = []
    for mark in sorted(every, key=lambda mark: (mark.operations, mark.largest)):
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
        if mark in best and mark.kind not in ("published", "exact"):
            _label(axes, mark)
    integral = INTEGRALS[quantity]
    errors = np.log10([mark.largest for mark in every])
    axes.set(yscale="log", xscale="log", title=f"${integral.symbol}$")
    axes.set(xlabel=_COUNTED.get(quantity, "operations"), ylabel="largest error")
    axes.set_ylim(10 ** np.floor(errors.min() - 0.3), 10 ** np.ceil(errors.max() + 0.3))
    axes.tick_params(labelbottom=True)
    axes.grid(color="#e5e5e5", lw=0.6)
    axes.set_axisbelow(True)


def _label(axes: Axes, mark: Mark) -> None:
    axes.annotate(
        mark.name.removeprefix("best/"),
        (mark.operations, mark.largest),
        xytext=(6, 4),
        textcoords="offset points",
        fontsize=7.5,
    )


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
