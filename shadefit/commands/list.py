"""`shadefit list`: list the packaged tables."""

from typing import TYPE_CHECKING

from shadefit.commands.options import Json

if TYPE_CHECKING:
    from coefficients.table import Table


def list_tables(json: Json = False) -> None:
    """List the tables that come with shadefit, with their names, forms, errors and domains."""
    from coefficients.packaged import kind_of, names, packaged_table
    from shadefit.outputs import ListOutput
    from shadefit.records import TableRecord, table_fields
    from shadefit.terminal import print_json, print_table

    tables = {name: packaged_table(name) for name in names()}
    if json:
        records = [
            TableRecord(**table_fields(name, kind_of(name), table))
            for name, table in tables.items()
        ]
        print_json(ListOutput(tables=records))
        return
    print_table(
        "Tables",
        ["name", "rms", "largest", "of", "form", "in"],
        [
            [name, *_errors(table), table.quantity, table.form, _domain(table)]
            for name, table in tables.items()
        ],
        "Errors as the table states them, off the grid; 'compare' measures published ones. Those "
        "with ≤ are proven.",
        below=3,
    )


def _errors(table: "Table") -> list[str]:
    from programs.rounded_text import rounded_up

    if table.errors is None:
        return ["—", "—"]
    proven = table.certificates.largest_error if table.certificates else None
    measured = f"{table.errors.off_grid.max:.3e}"
    largest = f"≤ {rounded_up(proven.upper, 4)}" if proven else measured
    return [f"{table.errors.off_grid.rms:.3e}", largest]


def _domain(table: "Table") -> str:
    ends = {each.name: each.domain for each in table.arguments}
    return ", ".join(f"{name} [{low:.4g}, {high:.4g}]" for name, (low, high) in ends.items())
