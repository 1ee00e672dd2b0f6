"""Entries and errors as `--json` prints them."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from coefficients.catalogue import Entry
from coefficients.packaged import Kind
from coefficients.table import Table
from fitting import Errors
from fitting.second_opinion import SecondOpinion
from shadefit.records import ErrorsRecord, RefittedTable, SecondOpinionRecord, table_fields


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


def made_table(
    table: Table, file: Path | None, kind: Kind, opinion: SecondOpinion | str | None = None
) -> RefittedTable:
    """Return a table that was made, with its whole content."""
    found = None
    if isinstance(opinion, SecondOpinion):
        shown = {key: value for key, value in asdict(opinion).items() if key != "other"}
        found = SecondOpinionRecord(**shown)
    fields = table_fields(table.name, kind, table, None if file is None else str(file))
    content = table.model_dump(by_alias=True, exclude_none=True)
    return RefittedTable(**fields, content=content, second_opinion=found)


def errors_record(errors: Errors) -> ErrorsRecord:
    """Return measured errors as `--json` prints them."""
    return ErrorsRecord(
        rms=errors.rms, max=errors.largest, where=errors.where, points=errors.points
    )
