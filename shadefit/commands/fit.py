"""`shadefit fit`: fit forms to measured data, without a problem file."""

import re
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from shadefit.commands.form_texts import form_name, parsed_form, with_form
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

if TYPE_CHECKING:
    from fitting.second_opinion import SecondOpinion as Opinion
    from shadefit.declaration import Problem
    from shadefit.result import Result

# Of fewer rows, none is held out by default: all are needed for the fit.
_FEW = 100
_HOLD_OUT = 5


def fit(
    data: Annotated[Path, typer.Argument(help="File of columns: CSV with a header, NPY or NPZ.")],
    x: Annotated[str, typer.Option("--x", help="Columns of the axes, separated by commas.")],
    y: Annotated[
        str,
        typer.Option(
            "--y", help="Column of the values; with --shared-denominator several, as in R,G,B."
        ),
    ],
    form: Annotated[
        list[str],
        typer.Option(
            help="Form to fit; may be given again. rational:M,N (degrees above and below; of "
            "several axes the total degrees), polynomial:N, chebyshev:N or N,M for each axis, "
            "piecewise:KNOTS likewise; exponentials:TERMS,DEGREE along the first axis, whose "
            "coefficients have this degree in the others; of one axis poles:POLES,DEGREE."
        ),
    ],
    sigma: Annotated[
        str | None, typer.Option(help="Column of the standard deviations of the values.")
    ] = None,
    hold_out: Annotated[
        int | None,
        typer.Option(
            help="One row of this many is kept from the fits and judges them; 0: none. By default "
            "5, or 0 for fewer than 100 rows."
        ),
    ] = None,
    shared_denominator: Annotated[
        bool,
        typer.Option(
            "--shared-denominator",
            help="Fit the columns of --y together by rationals with one denominator. shadefit "
            "export A B --together NAME then computes it once.",
        ),
    ] = False,
    name: Annotated[
        str | None, typer.Option(help="Name of the quantity; by default the column of the values.")
    ] = None,
    shader: Annotated[str | None, typer.Option(help="Name of the exported function.")] = None,
    norm: Norm = None,
    side: Side = None,
    rounding: Rounding = None,
    relative: Relative = False,
    bounded: Bounded = False,
    second_opinion: SecondOpinion = False,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for NAME.json, or NAME-FORM.json of several forms."),
    ] = None,
    json: Json = False,
) -> None:
    """Fit forms to the rows of a file, and print coefficients, errors and proofs.

    The domain of each axis is the range of its column. Errors are those at
    the rows that are held out, or if there are none, at all rows.
    """
    from coefficients.files import require_writable, write_whole
    from coefficients.table import serialise
    from integrals.data import table
    from shadefit.commands.shared_fits import shared_fits
    from shadefit.encoding import visible
    from shadefit.outputs import FitOutput
    from shadefit.terminal import print_json

    columns = [part.strip() for part in x.split(",")]
    wanted = [part.strip() for part in y.split(",")] if shared_denominator else [y]
    found = table(data, columns, wanted[0], sigma)
    if hold_out is None:
        hold_out = 0 if len(found.values) < _FEW else _HOLD_OUT
    goal = goal_fields(norm, side, rounding, relative, bounded)
    command = ["shadefit", "fit", str(data), "--x", x, "--y", y]
    command += [] if sigma is None else ["--sigma", sigma]
    command += ["--hold-out", str(hold_out)]
    if shared_denominator and (name or shader or second_opinion):
        raise ValueError("--shared-denominator: names and a second opinion are for one column")
    owners = [
        _problem(
            table(data, columns, each, sigma, hold_out),
            columns,
            each if shared_denominator else name or each,
            shader,
            data,
        )
        for each in wanted
    ]
    if out is not None:
        require_writable(out)
    refused: list[str] = []
    if shared_denominator:
        results = shared_fits(owners, form, goal, shlex.join([*command, "--shared-denominator"]))
    else:
        for each in form:
            _add(owners[0], each)
        results, refused = _fits(owners[0], goal, shlex.join(command), form)
    for reason in refused:
        print(visible(f"refused: {reason}"), file=sys.stderr)
    opinions = [each.second_opinion() if second_opinion else None for each in results]
    several = len(form) > 1
    files = [
        out
        and out / f"{each.problem.name}{f'-{each.fit.fitted.form.name}' if several else ''}.json"
        for each in results
    ]
    for each, file in zip(results, files, strict=True):
        if file is not None:
            write_whole(file, serialise(each.table))
    if json:
        from shadefit.commands.table_records import made_table

        records = [
            made_table(each.table, file, "file", opinion)
            for each, file, opinion in zip(results, files, opinions, strict=True)
        ]
        print_json(FitOutput(tables=records))
        return
    _print(results, files, opinions)
    if several:
        _print_together(results)


def _print(
    results: "list[Result]", files: "list[Path | None]", opinions: "list[Opinion | None]"
) -> None:
    from shadefit.terminal import print_lines

    for each, file, opinion in zip(results, files, opinions, strict=True):
        print_lines(each)
        if opinion is not None:
            print(opinion_text(opinion))
        if file is not None:
            print_lines(file)


def _fits(
    owner: "Problem", goal: dict[str, Any], command: str, texts: list[str]
) -> "tuple[list[Result], list[str]]":
    """Fit every form. Return the results, and why others were refused.

    Raises ValueError if all are refused.
    """
    from shadefit.progress import stages
    from shadefit.result import fit_result

    results: list[Result] = []
    refused: list[str] = []
    with stages() as progress:
        line = progress.begin("forms", total=len(texts))
        for text, each in zip(texts, owner.forms, strict=True):
            line.show(f"{owner.name}: {text}")
            try:
                results.append(fit_result(owner, each, goal, with_form(command, text, goal)))
            except ValueError as error:
                refused.append(str(error))
            line.advance()
    if not results:
        raise ValueError("; ".join(refused))
    return results, refused


def _problem(
    found: Any, columns: list[str], name: str, shader: str | None, data: Path
) -> "Problem":
    """Return the quantity that the data are values of."""
    from integrals.reference import Axis
    from shadefit.declaration import Problem

    axes = []
    for k, column in enumerate(columns):
        low, high = found.points[:, k].min(), found.points[:, k].max()
        if not low < high:
            raise ValueError(f"{data}: column {column!r} has one value only: allowed are several")
        axes.append(Axis(_identifier(column), low, high, meaning=f"column {column}"))
    own = re.sub(r"[^a-z0-9._-]+", "-", name.lower()).strip("-._") or "data"
    return Problem(
        own,
        axes,
        found,
        symbol=name,
        definition=f"column {name} of {data.name}",
        meaning="measured",
        shader=shader or _identifier(name)[:1].upper() + _identifier(name)[1:],
    )


def _identifier(column: str) -> str:
    """Return a column's name as the name of an axis, which has letters, digits and _ only."""
    name = re.sub(r"\W+", "_", column, flags=re.ASCII).strip("_") or "x"
    # A digit cannot come first, and c0, t0 and the like mean coefficients and steps.
    return f"x_{name}" if name[0].isdigit() or re.fullmatch(r"[ct]\d+", name) else name


def _add(owner: "Problem", text: str) -> None:
    """Add the form that a text such as 'rational:2,2' describes."""
    kind, counts = parsed_form(text, len(owner.axes))
    _SHAPES[kind](owner, counts, form_name(text))


def _rational(owner: "Problem", counts: list[int], name: str) -> None:
    from fitting.shapes.monomial_sums import powers

    above, below = (powers(count, len(owner.axes), total=True) for count in counts)
    owner.rational(above, below, name=name)


_SHAPES: "dict[str, Callable[[Problem, list[int], str], Any]]" = {
    "rational": _rational,
    "polynomial": lambda owner, counts, name: owner.polynomial(counts[0], name=name),
    "chebyshev": lambda owner, counts, name: owner.chebyshev(
        counts * len(owner.axes) if len(counts) == 1 else counts, name=name
    ),
    "exponentials": lambda owner, counts, name: owner.exponentials(
        counts[0], degree=sum(counts[1:]), name=name
    ),
    "poles": lambda owner, counts, name: owner.pole_sum(*counts, name=name),
    "piecewise": lambda owner, counts, name: owner.piecewise_linear(
        counts[0] if len(counts) == 1 else counts, name=name
    ),
}


def _print_together(results: "list[Result]") -> None:
    from shadefit.terminal import print_table

    print_table(
        "All forms",
        ["form", "coefficients", "operations", "rms", "largest"],
        [
            [
                each.fit.fitted.form.name,
                str(each.table.size),
                str(each.operations),
                f"{each.errors.rms:.3e}",
                f"{each.errors.largest:.3e}",
            ]
            for each in results
        ],
        f"Errors against {results[0].problem.reference.compared_with}.",
    )
