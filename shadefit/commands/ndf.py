"""`shadefit ndf`: fit a piecewise-linear NDF, and write it as a table and as shader code."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json
from shadefit.completion import complete_language

if TYPE_CHECKING:
    from coefficients.ndf_table import NdfTable
    from shadefit.outputs import NdfCheck


def ndf(
    source: Annotated[
        str,
        typer.Argument(
            help="What is fitted: ggx:WIDTH, beckmann:WIDTH, student-t:WIDTH,EXPONENT, or a file "
            "of columns (CSV with a header, NPY or NPZ); or the table NAME.json of an NDF, which "
            "is exported or verified as it is."
        ),
    ],
    theta: Annotated[str, typer.Option(help="Column of the polar angles of normals.")] = "theta",
    value: Annotated[
        str, typer.Option(help="Column of the NDF's values, in any unit: they are normalised.")
    ] = "D",
    degrees: Annotated[bool, typer.Option("--degrees", help="The angles are in degrees.")] = False,
    segments: Annotated[int, typer.Option(help="Number of segments.", min=2, max=256)] = 32,
    linear_in: Annotated[
        str,
        typer.Option(
            help="What the NDF is linear in between knots: cos2 (cos² of the angle; Lambda has a "
            "closed form) or angle (as published; without shader code)."
        ),
    ] = "cos2",
    monotone: Annotated[
        bool, typer.Option("--monotone", help="The NDF does not increase with the angle.")
    ] = False,
    to: Annotated[
        str | None,
        typer.Option(help="Language of the code for --code.", autocompletion=complete_language),
    ] = None,
    code: Annotated[Path | None, typer.Option(help="File for the shader code.")] = None,
    name: Annotated[str, typer.Option(help="Beginning of the names of functions.")] = "Ndf",
    verify: Annotated[
        bool, typer.Option("--verify", help="Compile and run the code of --to, and compare it.")
    ] = False,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="File for the table.")] = None,
    json: Json = False,
) -> None:
    """Fit the values of an isotropic distribution of normals at knots, by linear programs.

    Mass and grazing shadows are those of the source. Prints the total
    variation and the largest error of the masking G1. Fits whose knots miss the peak are refused.
    """
    from coefficients.files import write_whole
    from coefficients.ndf_table import serialise_ndf
    from shadefit.outputs import NdfCheck, NdfOutput
    from shadefit.terminal import print_json

    _require(linear_in, to, code, verify, out)
    fitting = {
        "theta": theta,
        "D": value,
        "degrees": degrees,
        "segments": segments,
        "linear_in": linear_in,
        "monotone": monotone,
    }
    table = _table(source, fitting)
    text, checks = None, []
    if to is not None:
        from coefficients.ndf_code import check_ndf, ndf_source

        text = ndf_source(table, to, name=name)
        checks = check_ndf(table, to) if verify else []
    if out is not None:
        write_whole(out, serialise_ndf(table))
    if code is not None and text is not None:
        write_whole(code, text)
    files = [str(each) for each in (out, code) if each is not None]
    parts = ("D", "Hidden", "Visibility", "SquaredSine")
    verified = [
        NdfCheck(
            function=f"{name}{part}",
            language=each.language,
            status=each.status,
            reason=each.reason,
        )
        for part, each in zip(parts, checks, strict=False)
    ]
    if json:
        print_json(
            NdfOutput(
                target=table.target,
                linear_in=table.linear_in,
                segments=len(table.knots) - 1,
                mass=table.mass,
                total_variation=table.errors.total_variation,
                masking=table.errors.masking,
                directions=table.errors.directions,
                knots=table.knots,
                values=table.values,
                checks=verified,
                files=files,
            )
        )
    else:
        _print(table, verified, files)
    if any(each.status == "failed" for each in verified):
        raise typer.Exit(1)


def _require(
    linear_in: str, to: str | None, code: Path | None, verify: bool, out: Path | None
) -> None:
    """Raise ValueError for options that do not go together, before long work."""
    from coefficients.files import require_writable_file
    from programs import language

    if linear_in not in ("cos2", "angle"):
        raise ValueError(f"--linear-in {linear_in}: allowed are cos2, angle")
    if to is None and (code is not None or verify):
        raise ValueError("--code and --verify need the language: give --to")
    if to is not None and not (code is not None or verify):
        raise ValueError("--to needs --code FILE or --verify")
    if to is not None and linear_in == "angle":
        raise ValueError("--to: code is written for NDFs that are linear in cos2 only")
    if to is not None:
        language(to)
    for file in (out, code):
        if file is not None:
            require_writable_file(file)


def _print(table: "NdfTable", verified: "list[NdfCheck]", files: list[str]) -> None:
    from shadefit.terminal import print_table

    print_table(
        f"{table.target}, linear in {table.linear_in} between {len(table.knots)} knots",
        ["mass of the interpolated", "total variation", "largest error of G1"],
        [
            [
                f"{table.mass:.4f}",
                f"{table.errors.total_variation:.2e}",
                f"{table.errors.masking:.2e}",
            ]
        ],
        f"The mass is that of the source interpolated at these knots; that of the fit is 1. "
        f"G1 at {table.errors.directions} directions.",
    )
    for each in verified:
        why = f": {each.reason}" if each.reason else ""
        print(f"{each.function} in {each.language}: {each.status}{why}")
    for each in files:
        print(each)


def _table(source: str, given: dict) -> "NdfTable":
    """Return the table of a file, or that of a fit to what the source names."""
    from coefficients.ndf_table import SCHEMA, NdfErrors, NdfTable, read_ndf

    path = Path(source)
    if path.suffix == ".json":
        return read_ndf(path)
    from quantities.piecewise.fit import fit_ndf
    from quantities.piecewise.targets import analytic_ndf, measured_ndf

    command = ["shadefit", "ndf", source]
    if path.exists() or path.suffix in (".csv", ".npy", ".npz"):
        target = measured_ndf(path, given["theta"], given["D"], degrees=given["degrees"])
        command += ["--theta", given["theta"], "--value", given["D"]]
        command += ["--degrees"] if given["degrees"] else []
    else:
        target = analytic_ndf(source)
    segments, linear_in, monotone = given["segments"], given["linear_in"], given["monotone"]
    command += ["--segments", str(segments), "--linear-in", linear_in]
    command += ["--monotone"] if monotone else []
    fit = fit_ndf(target, segments, variable=linear_in, monotone=monotone)
    return NdfTable(
        schema=SCHEMA,
        target=fit.target,
        linear_in=linear_in,
        monotone=monotone,
        knots=[float(each) for each in fit.profile.knots],
        values=[float(each) for each in fit.profile.values],
        mass=fit.mass,
        errors=NdfErrors(
            total_variation=fit.total_variation,
            masking=fit.masking_error,
            directions=fit.directions,
        ),
        command=shlex.join(command),
    )
