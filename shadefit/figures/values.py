"""What is drawn of a quantity: its hints, and exact and exported values on grids of points."""

import re
from collections.abc import Iterable, Sequence

import numpy as np

from coefficients.catalogue import Entry, entries, published, refitted
from coefficients.exported_code import exported_values
from integrals.reference import Axis, Reference
from quantities import Problem
from quantities.plot_hints import AxisHint, PlotHints
from shadefit.figures.style import KINDS

_FITTED = "fitted table"


def hints_of(owner: Problem) -> PlotHints:
    """Return how a quantity is drawn; without hints of its own, by defaults from its axes."""
    return owner.plot or PlotHints()


def axis_hints(owner: Problem) -> list[tuple[Axis, AxisHint]]:
    """Return each axis of a quantity with its hint."""
    hints = hints_of(owner)
    return [(axis, hints.axis(axis)) for axis in owner.axes]


def points_along(hint: AxisHint, count: int, *, logarithmic: bool = False) -> np.ndarray:
    """Return values (count,) along the range of an axis that pictures show, even or logarithmic."""
    space = np.geomspace if logarithmic else np.linspace
    return space(hint.lower, hint.upper, count)


def mesh(*axes: np.ndarray) -> np.ndarray:
    """Return the points (…, axes) of a tensor grid: its shape has the length of each axis."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def exact(reference: Reference, points: np.ndarray) -> np.ndarray:
    """Evaluate the exact values at points (…, axes): (…)."""
    return reference.values(points.reshape(-1, points.shape[-1])).reshape(points.shape[:-1])


def best_tables(owner: Problem) -> list[Entry]:
    """Return the best tables of a quantity, the one with the largest stated error first."""
    found = [entry for entry in entries(owner) if entry.kind == "best"]
    return sorted(found, key=_stated_error, reverse=True)


def _stated_error(entry: Entry) -> float:
    errors = entry.require_table().errors
    return np.inf if errors is None else errors.off_grid.max


def compared_tables(owner: Problem) -> list[Entry]:
    """Return the published and the refitted table of a quantity, as far as they are kept."""
    return [entry for entry in (published(owner), refitted(owner)) if entry is not None]


def compared_values(
    owner: Problem, points: np.ndarray, tables: Iterable[Entry] | None = None
) -> dict[str, np.ndarray]:
    """Evaluate the exact values and tables; None stands for `compared_tables`.

    Tables are evaluated by their exported functions, with the clamps. Returns values (…) at points
    (…, axes), by label.
    """
    chosen = compared_tables(owner) if tables is None else tables
    values = {"exact": exact(owner.reference, points)}
    return values | {label_of(entry): exported_values(entry, points) for entry in chosen}


def label_of(entry: Entry) -> str:
    """Return what pictures call a table: 'published', 'refitted', or its name."""
    return entry.kind if entry.kind in ("published", "refitted") else entry.name


def kind_label(kind: str, owner: Problem) -> str:
    """Return what a legend calls a kind of tables. Without a published form nothing is refitted."""
    return _FITTED if kind == "refitted" and published(owner) is None else KINDS[kind]


def round_up(value: float, steps: Sequence[float] = (1.0, 2.0, 5.0, 10.0)) -> float:
    """Return the least step times a power of ten that is not below `value`; at least 1e-9."""
    if value <= 1e-9:
        return 1e-9
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(m * power for m in steps if m * power >= value))


def math_symbol(owner: Problem) -> str:
    """Return the symbol of a quantity as Matplotlib's mathematical text."""
    return "$" + re.sub(r"_(\w{2,})", r"_{\1}", owner.symbol) + "$"


def error_text(value: float) -> str:
    """Return an error with two digits, such as 0.014 or 8.0e-5."""
    if abs(value) >= 1e-3:
        return f"{value:#.2g}"
    digits, exponent = f"{value:.1e}".split("e")
    return f"{digits}e{int(exponent)}"
