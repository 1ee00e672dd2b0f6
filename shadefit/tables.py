"""`shadefit list`: what tables there are."""

from coefficients.catalogue import load, names
from coefficients.table import Table
from shadefit.terminal import print_json, print_table


def list_tables(json: bool) -> None:
    """List every table that a name stands for."""
    tables = {name: load(name) for name in names()}
    if json:
        print_json({"tables": [_record(name, table) for name, table in tables.items()]})
        return
    print_table(
        "Tables",
        ["name", "quantity", "form", "equation", "rms", "largest"],
        [
            [name, table.quantity, table.form, _short(table.equation), *_errors(table)]
            for name, table in tables.items()
        ],
        "Errors as the table states them, off the grid; 'compare' measures published ones.",
    )


def _record(name: str, table: Table) -> dict:
    errors = table.errors.off_grid if table.errors else None
    return {
        "name": name,
        "quantity": table.quantity,
        "form": table.form,
        "equation": table.equation,
        "rms": errors.rms if errors else None,
        "max": errors.max if errors else None,
    }


def _short(equation: str) -> str:
    """Leave out what is too long for a column: --json has it."""
    return equation if len(equation) <= 20 else "—"


def _errors(table: Table) -> list[str]:
    if table.errors is None:
        return ["—", "—"]
    return [f"{table.errors.off_grid.rms:.3e}", f"{table.errors.off_grid.max:.3e}"]
