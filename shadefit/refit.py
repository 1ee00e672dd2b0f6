"""`shadefit refit`: refit the paper's forms and write their tables."""

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from coefficients.catalogue import QUANTITIES, from_fit
from coefficients.table import Table, serialise, write_whole
from fitting import Weight, refit
from shadefit.terminal import print_json, print_table, stages

ALL = "all"
# Compilation holds one core at a time: a second fit fills the other.
WORKERS = 2


def run(names: list[str], out: Path, grid: int, weight: Weight, as_json: bool) -> None:
    """Refit, and write `out`/NAME.json for each; nothing is written unless every fit holds."""
    chosen = selection(names)
    require_writable(out)
    with stages() as progress, ThreadPoolExecutor(WORKERS) as workers:

        def make(name: str) -> Table:
            task = progress.add_task(name, total=None)

            def tell(stage: str) -> None:
                progress.update(task, description=f"{name}: {stage}")

            command = f"shadefit refit {name} --grid {grid} --weight {weight}"
            table = from_fit(refit(name, grid, weight, tell), command)
            tell("done")
            return table

        tables = list(workers.map(make, chosen))
    for table in tables:
        write_whole(out / f"{table.name}.json", serialise(table))
    if as_json:
        print_json({"tables": [_record(table, out) for table in tables]})
    else:
        print_table(
            "Refitted tables",
            ["table", "equation", "coefficients", "rms", "largest", "denominators ≥", "file"],
            [_row(table, out) for table in tables],
            "Errors are measured off the grid, against exact values.",
        )


def selection(names: list[str]) -> list[str]:
    """Give the quantities that are meant, in their own order; 'all' or nothing means each."""
    unknown = [name for name in names if name not in (*QUANTITIES, ALL)]
    if unknown:
        allowed = ", ".join((*QUANTITIES, ALL))
        raise ValueError(f"nothing is called {unknown[0]!r}: allowed are {allowed}")
    if not names or ALL in names:
        return list(QUANTITIES)
    return [name for name in QUANTITIES if name in names]


def require_writable(folder: Path) -> None:
    """Raise ValueError now, rather than after the work, if files cannot be made in a folder."""
    existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not existing.is_dir():
        raise ValueError(f"{existing} is no folder")
    if not os.access(existing, os.W_OK | os.X_OK):
        raise ValueError(f"{folder} cannot be written: Permission denied")


def _record(table: Table, out: Path) -> dict:
    data = table.model_dump(by_alias=True, exclude_none=True)
    return {"file": str(out / f"{table.name}.json"), **data}


def _row(table: Table, out: Path) -> list[str]:
    errors, certificates = table.errors, table.certificates
    assert errors is not None
    assert certificates is not None
    bound = certificates.denominator_bound
    return [
        table.name,
        table.equation,
        str(sum(len(row) if isinstance(row, list) else 1 for row in table.coefficients)),
        f"{errors.off_grid.rms:.4e}",
        f"{errors.off_grid.max:.4e}",
        "none" if bound is None else f"{bound:.3g}",
        str(out / f"{table.name}.json"),
    ]
