"""Entries and errors as `--json` prints them."""

from typing import Any

from coefficients.catalogue import Entry
from fitting import Errors
from shadefit.records import ErrorsRecord, table_fields


def entry_fields(entry: Entry, measured: Errors | None = None) -> dict[str, Any]:
    """Return the fields of a `TableRecord` of what a name stands for.

    Its errors are those that were measured, or else those that the table states.
    """
    return {**_fields(entry), **({} if measured is None else {"errors": errors_record(measured)})}


def _fields(entry: Entry) -> dict[str, Any]:
    file = entry.name if entry.kind == "file" else None
    if entry.table is not None:
        return table_fields(entry.name, entry.kind, entry.table, file)
    return {
        "name": entry.name,
        "kind": entry.kind,
        "quantity": entry.problem.name,
        "form": None,
        "equation": entry.equation,
        "file": file,
        "errors": None,
    }


def errors_record(errors: Errors) -> ErrorsRecord:
    """Return measured errors as `--json` prints them."""
    return ErrorsRecord(
        rms=errors.rms, max=errors.largest, where=errors.where, points=errors.points
    )
