"""`shadefit refit`: fit published forms, or those of best tables, to exact values; write tables."""

import shlex
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from shadefit.commands.names import require_quantities
from shadefit.commands.options import (
    Bounded,
    Json,
    Norm,
    Relative,
    Rounding,
    Side,
    goal_fields,
)
from shadefit.completion import complete_quantity

if TYPE_CHECKING:
    from coefficients.catalogue import Entry
    from coefficients.table import Table
    from quantities import Problem
    from shadefit.records import RefittedTable

ALL = "all"
# Two fits run at a time: while JAX compiles one on one core, the other uses a second core.
WORKERS = 2


def refit(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help="ps, g, q, r, velvet, all of these (the default), or best/NAME.",
            autocompletion=complete_quantity,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for NAME.json; by default, in a checkout, the packaged table is replaced."
        ),
    ] = None,
    grid: Annotated[
        int, typer.Option(help="Nodes along each axis of the grid, 9 to 129; not for best/NAME.")
    ] = 65,
    weight: Annotated[
        str,
        typer.Option(
            help="Weight of light directions in the fit of ps: uniform in angles, solid-angle, or "
            "cosine (projected solid angle). Other quantities have no such weight."
        ),
    ] = "uniform",
    norm: Norm = None,
    side: Side = None,
    rounding: Rounding = None,
    relative: Relative = False,
    bounded: Bounded = False,
    json: Json = False,
) -> None:
    """Fit the forms of the paper, or those of best tables, to exact values, and write tables."""
    given = goal_fields(norm, side, rounding, relative, bounded)
    run(names or [], out, grid, weight, given, json)


def run(
    names: list[str],
    out: Path | None,
    grid: int,
    weight: str,
    given: dict[str, Any],
    as_json: bool,
) -> None:
    """Refit tables, and write `out`/NAME.json for each. If any fit fails, nothing is written.

    If `out` is None, the packaged tables of the checkout are replaced. `given` has the fields of
    the goal that replace those of the table's own goal.
    """
    from coefficients.packaged import names_of_best

    require_quantities(names, "nothing is called", (ALL, *names_of_best()))
    from concurrent.futures import ThreadPoolExecutor

    from coefficients.files import require_writable, write_whole
    from coefficients.table import serialise
    from shadefit.progress import stages
    from shadefit.records import RefitOutput
    from shadefit.terminal import print_json, print_table

    _require_measure(weight)
    chosen = selection(names)
    for owner in [each for each in chosen if given and _has_own_goal(each)]:
        if owner.name in names:
            raise ValueError(
                f"{owner.name} has a goal of its own:{_options(given)} is for the others"
            )
        chosen.remove(owner)
    folders = [out or _own_folder(each.name) for each in chosen]
    for folder in set(folders):
        require_writable(folder)
    with stages() as progress, ThreadPoolExecutor(WORKERS) as workers:

        def make(each: "Problem | Entry") -> "Table":
            line = progress.begin(each.name)

            def tell(stage: str) -> None:
                line.show(f"{each.name}: {stage}")

            table = _table(each, grid, weight, given, tell)
            line.end(f"{each.name}: done")
            whole.advance()
            return table

        whole = progress.begin("tables", total=len(chosen))

        tables = list(workers.map(make, chosen))
    files = [folder / f"{table.name}.json" for folder, table in zip(folders, tables, strict=True)]
    for table, file in zip(tables, files, strict=True):
        write_whole(file, serialise(table))
    if as_json:
        records = [_record(table, file) for table, file in zip(tables, files, strict=True)]
        print_json(RefitOutput(tables=records))
    else:
        print_table(
            "Refitted tables",
            ["table", "equation", "coefficients", "rms", "largest", "denominators ≥", ""],
            [_row(table, file) for table, file in zip(tables, files, strict=True)],
            "Errors are measured off the grid, against exact values.",
            below=1,
        )


def selection(names: list[str]) -> "list[Problem | Entry]":
    """Return the quantities and best tables with these names.

    Quantities come first, in the order of the registry. 'all' stands for all of them; no name, for
    those of the user's problem files or, if there are none, for all.
    """
    from coefficients.catalogue import resolve
    from coefficients.packaged import names_of_best
    from quantities import problems

    every, best = problems(), names_of_best()
    names = names or [owner.name for owner in every.values() if not owner.topic]
    unknown = [name for name in names if name not in (*every, ALL, *best)]
    if unknown:
        allowed = ", ".join((*every, ALL, *best))
        raise ValueError(f"nothing is called {unknown[0]!r}: allowed are {allowed}")
    whole = not names or ALL in names
    owners = [owner for name, owner in every.items() if whole or name in names]
    return [*owners, *(resolve(name) for name in best if name in names)]


def _require_measure(weight: str) -> None:
    """Raise ValueError for a measure that no quantity has."""
    from quantities import problems

    every = (owner.reference.sampling.measures for owner in problems().values())
    known = dict.fromkeys(name for measures in every for name in measures)
    if weight not in known:
        raise ValueError(f"weight = {weight!r}: allowed are {', '.join(known)}")


def _has_own_goal(each: "Problem | Entry") -> bool:
    """Return whether a quantity's default form has a solver with a fixed goal of its own."""
    from fitting.goal import LEAST_SQUARES
    from quantities import Problem

    solver = each.default.solver if isinstance(each, Problem) else None
    return getattr(solver, "goal", LEAST_SQUARES) != LEAST_SQUARES


def _own_folder(name: str) -> Path:
    """Return the folder of a packaged table, relative to the working directory if it is inside."""
    from coefficients.catalogue import is_kept, path_of
    from coefficients.packaged import in_checkout

    if not is_kept(name):
        raise ValueError(f"{name} has no folder of its own: give one by --out")
    if not in_checkout():
        raise ValueError(f"{name} comes with an installed package: give a folder by --out")
    folder, here = path_of(name).parent, Path.cwd()
    return folder.relative_to(here) if folder.is_relative_to(here) else folder


def _table(
    each: "Problem | Entry",
    grid: int,
    weight: str,
    given: dict[str, Any],
    tell: Callable[[str], None],
) -> "Table":
    from coefficients.record import table_of
    from fitting.fit import fit
    from fitting.goal import Goal
    from quantities import Problem
    from quantities.loader import option_for

    if isinstance(each, Problem):
        file = "".join(f" {shlex.quote(word)}" for word in option_for(each))
        command = (
            f"shadefit refit{file} {each.name} --grid {grid} --weight {weight}{_options(given)}"
        )
        return table_of(fit(each.default, Goal(**given), grid, weight, tell), command)
    table = each.require_table()
    own = {} if table.goal is None else table.goal.model_dump()
    goal = Goal(**{**own, **given})
    made = fit(each.require_fitted().form, goal, measure=weight, progress=tell)
    options = _options({**({} if weight == "uniform" else {"weight": weight}), **given})
    return table_of(made, f"shadefit refit {each.name}{options}", table.name)


def _options(given: dict[str, Any]) -> str:
    """Return the command-line options for the given fields of a goal, as text."""
    flags = {
        key: f" --{key}" if value is True else f" --{key} {value}" for key, value in given.items()
    }
    return "".join(flags.values())


def _record(table: "Table", file: Path) -> "RefittedTable":
    from shadefit.records import RefittedTable, table_fields

    kind = "best" if table.name.startswith("best/") else "refitted"
    content = table.model_dump(by_alias=True, exclude_none=True)
    return RefittedTable(**table_fields(table.name, kind, table, str(file)), content=content)


def _row(table: "Table", file: Path) -> list[str]:
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
