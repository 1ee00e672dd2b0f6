"""Tables side by side, each against the exact integral on the same points."""

from dataclasses import dataclass

import numpy as np

from coefficients.catalogue import form_of
from coefficients.table import Table
from fitting import (
    Domain,
    Errors,
    Form,
    common_domain,
    form_values,
    judge,
    measure,
    off_grid_reference,
)


@dataclass(frozen=True)
class Entry:
    """One table of a comparison: its errors, and its rms error over the first table's."""

    label: str
    table: Table
    errors: Errors
    rms_ratio: float
    largest_ratio: float


@dataclass(frozen=True)
class Comparison:
    """Tables of one quantity on the same off-grid points of their common domain.

    `difference` and `where` tell by how much, and where, the last table differs most from the
    first.
    """

    quantity: str
    domain: Domain
    entries: tuple[Entry, ...]
    difference: float
    where: dict[str, float]


def compare(labelled: list[tuple[str, Table]]) -> Comparison:
    """Compare tables of one quantity; the first is what the others are measured by.

    The points are the off-grid set of the domain that all have in common: 2¹² for R, 2¹⁶ or more
    for the others. Raises ValueError when the quantities differ, or no part of their domains is
    common.
    """
    quantities = {table.quantity for _, table in labelled}
    if len(quantities) != 1:
        raise ValueError(f"tables of different quantities: {', '.join(sorted(quantities))}")
    forms: list[Form] = [form_of(table) for _, table in labelled]
    domain = common_domain([type(form) for form in forms])
    points, _ = off_grid_reference(domain)
    values = [form_values(form, points) for form in forms]
    errors = [judge(form, domain) for form in forms]
    entries = tuple(
        Entry(label, table, e, e.rms / errors[0].rms, e.largest / errors[0].largest)
        for (label, table), e in zip(labelled, errors, strict=True)
    )
    apart = measure(values[-1] - values[0], points, domain)
    return Comparison(quantities.pop(), domain, entries, apart.largest, apart.where)


def as_json(comparison: Comparison) -> dict:
    """Give a comparison as plain JSON values, coefficients included."""
    return {
        "quantity": comparison.quantity,
        "domain": {axis.name: [axis.lower, axis.upper] for axis in comparison.domain.axes},
        "points": comparison.entries[0].errors.points,
        "tables": [
            {
                "table": entry.label,
                "form": entry.table.form,
                "equation": entry.table.equation,
                "rms": entry.errors.rms,
                "max": entry.errors.largest,
                "where": entry.errors.where,
                "rms_ratio": entry.rms_ratio,
                "max_ratio": entry.largest_ratio,
                "coefficients": entry.table.coefficients,
            }
            for entry in comparison.entries
        ],
        "coefficient_names": comparison.entries[0].table.coefficient_names,
        "largest_difference": {"value": comparison.difference, "where": comparison.where},
    }


def coefficient_rows(comparison: Comparison) -> list[tuple[str, list[float]]]:
    """Give every coefficient's name and its value in each table, for tables of one form."""
    names = np.ravel(np.array(comparison.entries[0].table.coefficient_names, dtype=object))
    columns = [np.ravel(entry.table.coefficients) for entry in comparison.entries]
    return [(str(name), [float(c[i]) for c in columns]) for i, name in enumerate(names)]
