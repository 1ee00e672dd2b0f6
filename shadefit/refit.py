"""`shadefit refit`: refit forms to exact values, the paper's or others, and write their tables."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from coefficients.catalogue import FOLDER, QUANTITIES, form_of, from_fit, load, names_of_best
from coefficients.files import require_writable, write_whole
from coefficients.table import Table, serialise
from fitting import Fit, Goal, Weight, improve, refit
from fitting.goal import LEAST_SQUARES
from shadefit.terminal import print_json, print_table, stages

ALL = "all"
# Compilation holds one core at a time: a second fit fills the other.
WORKERS = 2


def run(
    names: list[str],
    out: Path | None,
    grid: int,
    weight: Weight,
    given: dict[str, object],
    as_json: bool,
) -> None:
    """Refit, and write `out`/NAME.json for each; nothing is written unless every fit holds.

    `out` None: tables replace those that their names load. `given` holds the fields of a Goal that
    differ from the table's own.
    """
    chosen = selection(names)
    if given and "velvet" in chosen:
        if "velvet" in names:
            raise ValueError(f"velvet has a goal of its own:{_options(given)} is for the others")
        chosen.remove("velvet")
    folders = [out or _own_folder(name) for name in chosen]
    for folder in set(folders):
        require_writable(folder)
    with stages() as progress, ThreadPoolExecutor(WORKERS) as workers:

        def make(name: str) -> Table:
            task = progress.add_task(name, total=None)

            def tell(stage: str) -> None:
                progress.update(task, description=f"{name}: {stage}")

            table = _table(name, grid, weight, given, tell)
            tell("done")
            return table

        tables = list(workers.map(make, chosen))
    files = [folder / f"{table.name}.json" for folder, table in zip(folders, tables, strict=True)]
    for table, file in zip(tables, files, strict=True):
        write_whole(file, serialise(table))
    if as_json:
        records = [_record(table, file) for table, file in zip(tables, files, strict=True)]
        print_json({"tables": records})
    else:
        print_table(
            "Refitted tables",
            ["table", "equation", "coefficients", "rms", "largest", "denominators ≥", "file"],
            [_row(table, file) for table, file in zip(tables, files, strict=True)],
            "Errors are measured off the grid, against exact values.",
        )


def _own_folder(name: str) -> Path:
    """Give the folder that `load` takes a table from, by a short path where there is one."""
    folder = FOLDER / ("best" if name.startswith("best/") else "refit")
    here = Path.cwd()
    return folder.relative_to(here) if folder.is_relative_to(here) else folder


def _table(name: str, grid: int, weight: Weight, given: dict, tell: Callable[[str], None]) -> Table:
    if name in QUANTITIES:
        goal = Goal(**given)
        command = f"shadefit refit {name} --grid {grid} --weight {weight}{_options(given)}"
        fit = refit(name, grid, weight, tell)
        if goal != LEAST_SQUARES:
            fit = improve(type(fit.form), goal, tell, np.asarray(fit.form.coefficients), weight)
        return from_fit(fit, command)
    table = load(name)
    own = {} if table.goal is None else table.goal.model_dump()
    fit: Fit = improve(type(form_of(table)), Goal(**{**own, **given}), tell, weight=weight)
    options = _options({**({} if weight == "uniform" else {"weight": weight}), **given})
    return from_fit(fit, f"shadefit refit {name}{options}", table.name)


def _options(given: dict) -> str:
    """Write the options that a goal is asked for by."""
    flags = {
        key: f" --{key}" if value is True else f" --{key} {value}" for key, value in given.items()
    }
    return "".join(flags.values())


def selection(names: list[str]) -> list[str]:
    """Give the tables that are meant, quantities in their own order; 'all' or nothing: those."""
    best = names_of_best()
    unknown = [name for name in names if name not in (*QUANTITIES, ALL, *best)]
    if unknown:
        allowed = ", ".join((*QUANTITIES, ALL, *best))
        raise ValueError(f"nothing is called {unknown[0]!r}: allowed are {allowed}")
    if not names or ALL in names:
        return [*QUANTITIES, *(name for name in best if name in names)]
    return [name for name in (*QUANTITIES, *best) if name in names]


def _record(table: Table, file: Path) -> dict:
    data = table.model_dump(by_alias=True, exclude_none=True)
    return {"file": str(file), **data}


def _row(table: Table, file: Path) -> list[str]:
    errors, certificates = table.errors, table.certificates
    assert errors is not None
    assert certificates is not None
    bound = certificates.denominator_bound
    return [
        table.name,
        table.equation if len(table.equation) <= 20 else table.form,
        str(table.size),
        f"{errors.off_grid.rms:.4e}",
        f"{errors.off_grid.max:.4e}",
        "none" if bound is None else f"{bound:.3g}",
        str(file),
    ]
