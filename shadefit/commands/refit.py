"""`shadefit refit`: fit published forms, or those of best tables, to exact values; write tables."""

import shlex
import sys
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
    SecondOpinion,
    Side,
    goal_fields,
    opinion_text,
)
from shadefit.commands.selection import ALL, own_folder, parts, selection, table_name
from shadefit.completion import complete_quantity

if TYPE_CHECKING:
    from coefficients.catalogue import Entry
    from coefficients.table import Table
    from fitting import Form
    from fitting.fit import Fit
    from fitting.second_opinion import SecondOpinion as Opinion
    from quantities import Problem

# Two fits run at a time: while JAX compiles one on one core, the other uses a second core.
WORKERS = 2
# Nodes an axis, as in the paper.
_NODES = 65
# The measure that all quantities take
_EVENLY = "uniform"


def refit(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help="Quantities of 'shadefit list', such as ps or ggx-scale, all of them (the "
            "default), best/NAME, or quantities of -p FILE (by default all of these).",
            autocompletion=complete_quantity,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for NAME.json; by default, in a checkout, the packaged table is replaced."
        ),
    ] = None,
    form: Annotated[
        list[str] | None,
        typer.Option(
            help="Form of a user's quantity to fit, or all; by default its first. May be given "
            "again."
        ),
    ] = None,
    grid: Annotated[
        int | None,
        typer.Option(
            help="Nodes along each axis of the grid, 9 to 1025; by default 65. best/NAME, and a "
            "user's quantity by default, are fitted to scattered points instead."
        ),
    ] = None,
    weight: Annotated[
        str,
        typer.Option(
            help="Weight of light directions in the fit of ps: uniform in angles, solid-angle, or "
            "cosine (projected solid angle). Other quantities have no such weight."
        ),
    ] = _EVENLY,
    norm: Norm = None,
    side: Side = None,
    rounding: Rounding = None,
    relative: Relative = False,
    bounded: Bounded = False,
    second_opinion: SecondOpinion = False,
    json: Json = False,
) -> None:
    """Fit the forms of the paper, or those of best tables, to exact values, and write tables."""
    given = goal_fields(norm, side, rounding, relative, bounded)
    run(names or [], out, grid, weight, given, json, form or [], second_opinion)


def run(
    names: list[str],
    out: Path | None,
    grid: int | None,
    weight: str,
    given: dict[str, Any],
    as_json: bool,
    forms: list[str] | None = None,
    second_opinion: bool = False,
) -> None:
    """Refit tables, and write `out`/NAME.json for each. If any fit fails, nothing is written.

    If `out` is None, the packaged tables of the checkout are replaced. `given` has the fields of
    the goal that replace those of the table's own goal. `forms` names those to fit of users'
    quantities. If it is ['all'], a form whose fit fails is left out, and the reason is printed.
    """
    from coefficients.packaged import names_of_best

    require_quantities(names, "nothing is called", (ALL, *names_of_best()))
    from concurrent.futures import ThreadPoolExecutor

    from coefficients.files import require_writable, write_whole
    from coefficients.table import serialise
    from shadefit.outputs import RefitOutput
    from shadefit.progress import stages
    from shadefit.terminal import print_json, print_table

    _require_measure(weight)
    chosen = selection(names)
    for owner in [each for each in chosen if given and _has_own_goal(each)]:
        if owner.name in names:
            raise ValueError(
                f"{owner.name} has a goal of its own:{_options(given)} is for the others"
            )
        chosen.remove(owner)
    chosen = [part for each in chosen for part in parts(each, forms or [])]
    folders = [out or own_folder(table_name(each)) for each in chosen]
    for folder in set(folders):
        require_writable(folder)
    with stages() as progress, ThreadPoolExecutor(WORKERS) as workers:
        whole = progress.begin("tables", total=len(chosen))

        def make(
            each: "tuple[Problem, Form] | Entry",
        ) -> "tuple[Table, Opinion | str | None, str] | str":
            name = table_name(each)
            line = progress.begin(name)
            try:
                found = _table(
                    each,
                    grid,
                    weight,
                    given,
                    lambda stage: line.show(f"{name}: {stage}"),
                    second_opinion,
                )
            except ValueError as error:
                if ALL not in (forms or []):
                    raise
                line.end(f"{name}: refused")
                return str(error)
            line.end(f"{name}: done")
            whole.advance()
            return found

        made = list(workers.map(make, chosen))
    tables = [each[0] for each in made if not isinstance(each, str)]
    opinions = [each[1] for each in made if not isinstance(each, str)]
    refused = [each for each in made if isinstance(each, str)]
    if not tables:
        raise ValueError("; ".join(refused))
    _tell("refused", refused)
    _tell("warning", [each[2] for each in made if not isinstance(each, str) and each[2]])
    folders = [f for f, each in zip(folders, made, strict=True) if not isinstance(each, str)]
    files = [folder / f"{table.name}.json" for folder, table in zip(folders, tables, strict=True)]
    for table, file in zip(tables, files, strict=True):
        write_whole(file, serialise(table))
    if as_json:
        from shadefit.commands.table_records import made_table

        records = [
            made_table(
                table, file, "best" if table.name.startswith("best/") else "refitted", opinion
            )
            for table, file, opinion in zip(tables, files, opinions, strict=True)
        ]
        print_json(RefitOutput(tables=records))
    else:
        print_table(
            "Refitted tables",
            ["table", "form", "coefficients", "rms", "largest", "denominators ≥", ""],
            [_row(table, file) for table, file in zip(tables, files, strict=True)],
            "Errors are measured off the grid, against exact values.",
            below=1,
        )
        for table, opinion in zip(tables, opinions, strict=True):
            if opinion is not None:
                print(f"{table.name}: {opinion_text(opinion)}")


def _tell(word: str, reasons: list[str]) -> None:
    """Print each reason on standard error, after a word."""
    from shadefit.encoding import visible

    for reason in reasons:
        print(visible(f"{word}: {reason}"), file=sys.stderr)


def _require_measure(weight: str) -> None:
    """Raise ValueError for a measure that no quantity has."""
    # Every quantity can be fitted with the default, and importing all of them takes time.
    if weight == _EVENLY:
        return
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


def _table(
    each: "tuple[Problem, Form] | Entry",
    grid: int | None,
    weight: str,
    given: dict[str, Any],
    tell: Callable[[str], None],
    second_opinion: bool,
) -> "tuple[Table, Opinion | str | None, str]":
    """Return the table, the second opinion if it is wanted, and a warning, which may be empty."""
    from coefficients.record import table_of
    from fitting.fit import fit
    from fitting.goal import Goal
    from quantities.loader import option_for

    if isinstance(each, tuple):
        owner, form = each
        # The forms of the paper are fitted on a grid, as the paper did.
        nodes = _NODES if grid is None and owner.topic else grid
        file = "".join(f" {shlex.quote(word)}" for word in option_for(owner))
        other = "" if form is owner.default else f" --form {shlex.quote(form.name)}"
        on_grid = "" if nodes is None else f" --grid {nodes}"
        weighted = f" --weight {weight}" if owner.topic else ""
        command = f"shadefit refit{file} {owner.name}{other}{on_grid}{weighted}{_options(given)}"
        search = owner.counterexamples()
        made = fit(form, Goal(**given), nodes, weight, tell, counterexamples=search)
        table = table_of(made, command, table_name(each), owner)
        return table, _opinion(made) if second_opinion else None, _warning(table, made)
    table = each.require_table()
    own = {} if table.goal is None else table.goal.model_dump()
    goal = Goal(**{**own, **given})
    made = fit(
        each.require_fitted().form,
        goal,
        measure=weight,
        progress=tell,
        counterexamples=each.problem.counterexamples(),
    )
    options = _options({**({} if weight == _EVENLY else {"weight": weight}), **given})
    command = f"shadefit refit {each.name}{options}"
    table = table_of(made, command, table.name, each.problem)
    return table, _opinion(made) if second_opinion else None, _warning(table, made)


def _warning(table: "Table", made: "Fit") -> str:
    """Return why a fit did not converge; an empty text if it did, or if that was not examined."""
    return f"{table.name} did not converge: {made.solver}" if made.converged is False else ""


def _opinion(made: "Fit") -> "Opinion | str":
    """Return what another solver finds; a text if there is none for this fit, that says why."""
    from fitting.second_opinion import second_opinion

    try:
        return second_opinion(made.fitted.form, made.goal, made)
    except ValueError as error:
        return str(error)


def _options(given: dict[str, Any]) -> str:
    """Return the command-line options for the given fields of a goal, as text."""
    flags = {
        key: f" --{key}" if value is True else f" --{key} {value}" for key, value in given.items()
    }
    return "".join(flags.values())


def _row(table: "Table", file: Path) -> list[str]:
    errors, certificates = table.errors, table.certificates
    assert errors is not None
    assert certificates is not None
    bound = certificates.denominator_bound
    return [
        table.name,
        table.form,
        str(table.size),
        f"{errors.off_grid.rms:.4e}",
        f"{errors.off_grid.max:.4e}",
        "none" if bound is None else f"{bound:.3g}",
        str(file),
    ]
