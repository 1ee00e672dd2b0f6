"""`shadefit evaluate`: evaluate a quantity at points, by exact methods and by tables."""

import functools
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from shadefit.commands.axis_options import axis_values
from shadefit.commands.names import require_quantities, require_tables
from shadefit.commands.options import Json
from shadefit.commands.point_files import csv_text, read_points, require_format, written
from shadefit.completion import complete_table

if TYPE_CHECKING:
    from coefficients.catalogue import Entry
    from fitting import FittedForm
    from integrals.reference import Estimate, Reference
    from quantities import Problem

MAX_SAMPLES = 1 << 24
# The options for the axes differ by quantity. Typer passes them on, and `axis_values` reads them.
SETTINGS = {"ignore_unknown_options": True}


def evaluate(
    integral: Annotated[
        str,
        typer.Argument(
            help="A quantity of 'shadefit list', such as ps or skin-lobe-sphere, or one of "
            "-p FILE.",
            metavar="QUANTITY",
        ),
    ],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(
            help="The arguments of the integral, each as an option.", metavar="--NAME VALUE ..."
        ),
    ] = None,
    table: Annotated[
        list[str] | None,
        typer.Option(
            help="Name or path of a further table; the option may be given several times.",
            autocompletion=complete_table,
        ),
    ] = None,
    samples: Annotated[int, typer.Option(help="Number of Monte Carlo samples.")] = 1 << 16,
    sequence: Annotated[
        Literal["random", "sobol"], typer.Option(help="Kind of the Monte Carlo points.")
    ] = "random",
    seed: Annotated[int, typer.Option(help="Seed of the Monte Carlo points.")] = 0,
    points: Annotated[
        Path | None,
        typer.Option(
            help="File of many points: CSV with the arguments' names in its first line, or an NPY "
            "array (points, arguments). Angles are in radians."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="With --points: the file to write, CSV or NPY; by default CSV is shown."),
    ] = None,
    json: Json = False,
) -> None:
    """Evaluate a quantity at one point, by all exact methods and by tables.

    The exact methods are closed form, quadrature and Monte Carlo, if they exist.
    The tables are the published, the refitted and the best ones, and those of --table.

    Each argument of the integral is an option:
    --alpha, --theta-f, --theta-u and --phi of ps; --density and --cos-v of g;
    --density of q; --alpha and --theta-f of r; --asymmetry of velvet.
    Without them, the options of another quantity are named.
    Angles are in radians, or in degrees with 'deg': 0.785, 0.785rad, 45deg.

    --points evaluates at many points, by the most exact method and by tables.
    The columns are the arguments, exact, error, and the tables; nan is no value.
    """
    if points is not None:
        if arguments:
            raise ValueError(f"{arguments[0]}: allowed are either arguments or --points, not both")
        run_points(integral, points, table or [], out, json)
        return
    if out is not None:
        raise ValueError("--out: allowed only with --points")
    run(integral, arguments or [], table or [], samples, sequence, seed, json)


def run(
    name: str,
    given: list[str],
    extra: list[str],
    samples: int,
    sequence: str,
    seed: int,
    json: bool,
) -> None:
    """Evaluate the quantity `name` at the point that the options `given` state.

    Prints the values of every leg, of the published, refitted and best tables, and of the tables
    that `extra` names.
    """
    require_quantities([name], "no integral is called")
    require_tables(extra)
    from shadefit.commands.table_records import entry_fields
    from shadefit.outputs import EvaluateOutput
    from shadefit.records import EvaluatedTable, Leg
    from shadefit.terminal import place, print_json, print_table

    owner = _owner(name)
    reference = owner.reference
    arguments = axis_values(owner, given)
    if not 2 <= samples <= MAX_SAMPLES:
        raise ValueError(f"samples = {samples}: allowed are 2 to {MAX_SAMPLES}")
    if not 0 <= seed < 1 << 63:
        raise ValueError(f"seed = {seed}: allowed are 0 to 2⁶³ − 1")
    tables = _tables(owner, extra)
    options = (("samples", samples), ("sequence", sequence), ("seed", seed))
    legs = {}
    for leg_name in reference.legs:
        leg = _compiled(reference, leg_name, options if leg_name == "monte_carlo" else ())
        estimate = leg(*arguments.values())
        legs[leg_name] = {"value": float(estimate.value), "error": float(estimate.error)}
    # Data have no value between their points: only tables can be evaluated there.
    exact = legs[reference.best_leg]["value"] if legs else None
    if exact is not None and not math.isfinite(exact):
        what = "has no limit" if math.isnan(exact) else "is infinite"
        raise ValueError(
            f"{owner.symbol} {what} at {place(arguments)}, and no value: "
            "allowed are all other points of its domain"
        )
    found = {
        label: _by_form(each.require_fitted(), arguments, exact) for label, each in tables.items()
    }
    if json:
        records = [
            EvaluatedTable(**entry_fields(tables[label]), label=label, **each)
            for label, each in found.items()
        ]
        exacts = {leg: Leg(**each) for leg, each in legs.items()}
        print_json(EvaluateOutput(quantity=name, where=arguments, legs=exacts, tables=records))
        return
    rows = [
        [leg_name.replace("_", " "), f"{leg['value']:.15g}", f"± {leg['error']:.1e}", ""]
        for leg_name, leg in legs.items()
    ]
    print_table(
        f"{owner.symbol} = {reference.definition}" if reference.definition else owner.symbol,
        ["by", "value", "error", ""],
        rows + [[label, *_cells(entry)] for label, entry in found.items()],
        "Error: stated by the leg (Monte Carlo: one standard error); of a table, its distance "
        "from the exact value.",
        below=1,
    )


def run_points(name: str, file: Path, extra: list[str], out: Path | None, json: bool) -> None:
    """Evaluate the quantity `name` at the points of a file; write the columns, or print them."""
    import numpy as np

    from coefficients.files import OUTPUT, require_writable_file, write_whole_bytes
    from shadefit.encoding import visible
    from shadefit.many_points import estimates, values
    from shadefit.outputs import PointsOutput
    from shadefit.terminal import print_json, print_lines

    owner = _owner(name)
    if out == OUTPUT:
        out = None
    if out is not None:
        require_format(out)
        require_writable_file(out)
    tables = _tables(owner, extra)
    points = read_points(file, owner.axes)
    columns = {axis.name: points[:, k] for k, axis in enumerate(owner.axes)}
    if owner.reference.legs:
        found = estimates(owner, points)
        columns |= {"exact": np.asarray(found.value), "error": np.asarray(found.error)}
    columns |= {label: values(each.require_fitted(), points) for label, each in tables.items()}
    if out is not None:
        write_whole_bytes(out, written(columns, require_format(out)))
    if json:
        # JSON has no nan.
        rows = {
            label: [value if math.isfinite(value) else None for value in column.tolist()]
            for label, column in columns.items()
        }
        print_json(
            PointsOutput(
                quantity=name,
                points=len(points),
                file=None if out is None else str(out),
                columns=list(columns),
                values=rows if out is None else None,
            )
        )
    elif out is None:
        print(visible(csv_text(columns)), end="")
    else:
        print_lines(out)


def _owner(name: str) -> "Problem":
    from quantities import problem
    from quantities.registry import names

    if name not in names():
        raise ValueError(f"no integral is called {name!r}: allowed are {', '.join(names())}")
    return problem(name)


@functools.lru_cache(maxsize=16)
def _compiled(
    reference: "Reference", leg: str, options: tuple[tuple[str, Any], ...]
) -> "Callable[..., Estimate]":
    """Compile a leg as a whole. JAX would need several times as long one operation at a time."""
    from integrals.compilation import jit_for_few_calls

    return jit_for_few_calls(functools.partial(reference.legs[leg], **dict(options)))


def _tables(owner: "Problem", extra: list[str]) -> "dict[str, Entry]":
    """Return the tables to show, by label: published, refitted and best ones, and those of `extra`.

    Raises ValueError if a table that `extra` names belongs to another quantity.
    """
    from coefficients.catalogue import entries, published, refitted, resolve

    known = {"published": published(owner), "refitted": refitted(owner)}
    found = {label: each for label, each in known.items() if each is not None}
    found |= {each.name: each for each in entries(owner) if each.kind == "best"}
    for name in extra:
        entry = resolve(name)
        if entry.problem is not owner:
            raise ValueError(
                f"table {name} is of {entry.problem.name}: allowed are those of {owner.name}"
            )
        entry.require_table()
        found[name] = entry
    return found


def _by_form(fitted: "FittedForm", arguments: dict[str, float], exact: float | None) -> dict:
    outside = [
        f"{axis.name} is outside {axis.domain}"
        for axis in fitted.axes
        if not axis.contains(arguments[axis.name])
    ]
    if outside:
        return {"value": None, "difference": None, "reason": "; ".join(outside)}
    value = _value_at(fitted, list(arguments.values()))
    if not math.isfinite(value):
        what = "no number" if math.isnan(value) else "infinite"
        return {"value": None, "difference": None, "reason": f"its value is {what} there"}
    return {
        "value": value,
        "difference": None if exact is None else value - exact,
        "reason": None,
    }


def _value_at(fitted: "FittedForm", point: list[float]) -> float:
    """Return a form's value at one point by NumPy: JAX would compile each of its operations."""
    import numpy as np

    from fitting.linearity import program_of
    from programs import evaluate as evaluate_program

    row = np.array([*np.ravel(fitted.coefficients), *point])
    return float(evaluate_program(program_of(fitted.form), row[None])[0, 0])


def _cells(entry: dict) -> list[str]:
    if entry["value"] is None:
        return ["—", "—", entry["reason"]]
    difference = "—" if entry["difference"] is None else f"{entry['difference']:+.1e}"
    return [f"{entry['value']:.15g}", difference, ""]
