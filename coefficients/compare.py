"""Comparisons of tables: the errors of each at the same points."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coefficients.catalogue import Entry
from coefficients.table import Table
from fitting import Domain, Errors, common_domain, form_values, judge
from fitting.errors import measure
from fitting.points.scattered import judging_points


@dataclass(frozen=True)
class Contestant:
    """One table of a comparison: its errors, and their ratios to the errors of the first table."""

    label: str
    table: Table
    errors: Errors
    rms_ratio: float
    largest_ratio: float


@dataclass(frozen=True)
class Comparison:
    """Tables of one quantity, compared at the same points of their common domain.

    `difference` is the largest difference between the values of the first and of the last table,
    and `where` is the point that has it.
    """

    quantity: str
    domain: Domain
    contestants: tuple[Contestant, ...]
    difference: float
    where: dict[str, float]


def compare(labelled: Sequence[tuple[str, Entry]]) -> Comparison:
    """Compare tables of one quantity, given as pairs of a label and an entry.

    Errors are measured by `fitting.judge` in the common part of all domains. Raises ValueError if
    the quantities differ, or if the domains have no common part.
    """
    quantities = {entry.problem.name for _, entry in labelled}
    if len(quantities) != 1:
        raise ValueError(f"tables of different quantities: {', '.join(sorted(quantities))}")
    fitted = [entry.require_fitted() for _, entry in labelled]
    domain = common_domain([each.form for each in fitted])
    points, _ = judging_points(domain)
    values = [form_values(each, points) for each in fitted]
    errors = [judge(each, domain) for each in fitted]
    contestants = tuple(
        Contestant(
            label,
            entry.require_table(),
            e,
            _ratio(e.rms, errors[0].rms),
            _ratio(e.largest, errors[0].largest),
        )
        for (label, entry), e in zip(labelled, errors, strict=True)
    )
    apart = measure(values[-1] - values[0], points, domain)
    return Comparison(quantities.pop(), domain, contestants, apart.largest, apart.where)


def _ratio(error: float, first: float) -> float:
    """Return the ratio of two errors, which may be 0: that of equal errors is 1."""
    if first == 0:
        return 1.0 if error == 0 else math.inf
    return error / first


def coefficient_rows(comparison: Comparison) -> list[tuple[str, list[float]]]:
    """Return each coefficient's name and its values in all tables, which must be of one form."""
    first = comparison.contestants[0].table
    names = np.ravel(np.array(first.coefficient_names, dtype=object))
    columns = [np.ravel(each.table.coefficients) for each in comparison.contestants]
    return [(str(name), [float(c[i]) for c in columns]) for i, name in enumerate(names)]
