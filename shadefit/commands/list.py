"""`shadefit list`: list the packaged tables."""

from typing import TYPE_CHECKING

from shadefit.commands.options import Json

if TYPE_CHECKING:
    from coefficients.table import Table

# A longer equation does not fit into a column. --json prints it.
_LONGEST = 20


def list_tables(json: Json = False) -> None:
    """List the tables that come with shadefit, with their names, forms and errors."""
    from coefficients.catalogue import entries
    from shadefit.terminal import print_json, print_table

    tables = {entry.name: entry.require_table() for entry in entries()}
    if json:
        print_json({"tables": [_record(name, table) for name, table in tables.items()]})
        return
    print_table(
        "Tables",
        ["name", "quantity", "form", "equation", "rms", "largest"],
        [
            [
                *(name, table.quantity, table.form),
                table.equation if len(table.equation) <= _LONGEST else "—",
                *_errors(table),
            ]
            for name, table in tables.items()
        ],
        "Errors as the table states them, off the grid; 'compare' measures published ones. Those "
        "with ≤ are proven.",
    )


def _record(name: str, table: "Table") -> dict:
    errors = table.errors.off_grid if table.errors else None
    proven = table.certificates.largest_error if table.certificates else None
    return {
        "name": name,
        "quantity": table.quantity,
        "form": table.form,
        "equation": table.equation,
        "rms": errors.rms if errors else None,
        "max": errors.max if errors else None,
        **({"proven_max": proven.upper} if proven else {}),
    }


def _errors(table: "Table") -> list[str]:
    from coefficients.proof_text import rounded_up

    if table.errors is None:
        return ["—", "—"]
    proven = table.certificates.largest_error if table.certificates else None
    measured = f"{table.errors.off_grid.max:.3e}"
    largest = f"≤ {rounded_up(proven.upper, 4)}" if proven else measured
    return [f"{table.errors.off_grid.rms:.3e}", largest]
