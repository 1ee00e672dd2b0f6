"""`shadefit ndf`: fit a piecewise-linear NDF, and write it as a table and as shader code."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json
from shadefit.completion import complete_language

if TYPE_CHECKING:
    from coefficients.ndf_table import NdfBlendTable, NdfTable
    from quantities.piecewise.targets import AnisotropicTarget, Target
    from shadefit.material_outputs import NdfCheck, NdfCost, NdfOutput


def ndf(
    source: Annotated[
        str,
        typer.Argument(
            help="What is fitted: ggx:WIDTH, beckmann:WIDTH, student-t:WIDTH,EXPONENT, or a file "
            "of columns (CSV with a header, NPY or NPZ); ggx:WIDTH,WIDTH or beckmann:WIDTH,WIDTH, "
            "with the widths along x and y, is fitted by a blend of two profiles; or the table "
            "NAME.json of an NDF, which is exported or verified as it is."
        ),
    ],
    across: Annotated[
        str | None,
        typer.Option(
            help="A second isotropic source, a name or a file: the NDF is the blend of SOURCE at "
            "azimuth 0 and of this one at 90 degrees."
        ),
    ] = None,
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
    cost: Annotated[
        bool,
        typer.Option(
            "--cost", help="Print the operations of the code, and the errors of textures instead."
        ),
    ] = False,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="File for the table.")] = None,
    json: Json = False,
) -> None:
    """Fit the values of a distribution of normals at knots, by linear programs.

    The mass of a fit is one. Prints the total variation and the largest error of
    the masking G1. Fits whose knots miss the peak are refused.
    """
    from coefficients.files import write_whole
    from coefficients.ndf_table import serialise_ndf
    from shadefit.material_outputs import NdfCheck
    from shadefit.terminal import messages_beside, print_json

    _require(linear_in, to, code, verify, out)
    table = _table(
        source,
        across,
        columns=(theta, value),
        degrees=degrees,
        segments=segments,
        linear_in=linear_in,
        monotone=monotone,
    )
    if cost and table.linear_in != "cos2":
        raise ValueError("--cost: code is written for NDFs that are linear in cos2 only")
    text, checks = None, {}
    if to is not None:
        from coefficients.ndf_code import check_ndf, ndf_source

        text = ndf_source(table, to, name=name)
        checks = check_ndf(table, to, name=name) if verify else {}
    if out is not None:
        write_whole(out, serialise_ndf(table))
    if code is not None and text is not None:
        write_whole(code, text)
    files = [str(each) for each in (out, code) if each is not None]
    verified = [
        NdfCheck(function=key, language=each.language, status=each.status, reason=each.reason)
        for key, each in checks.items()
    ]
    with messages_beside(out, code):
        if json:
            print_json(_output(table, verified, files, _costs(table) if cost else []))
        else:
            _print(table, verified, files)
            _print_costs(_costs(table) if cost else [])
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
    if code is not None and code == out:
        raise ValueError(f"--out and --code are both {out}: allowed are two files")
    for file in (out, code):
        if file is not None:
            require_writable_file(file)


def _output(
    table: "NdfTable | NdfBlendTable",
    verified: "list[NdfCheck]",
    files: list[str],
    costs: "list[NdfCost]",
) -> "NdfOutput":
    from coefficients.ndf_table import NdfTable
    from shadefit.material_outputs import NdfOutput, NdfProfile

    isotropic = isinstance(table, NdfTable)
    first = table if isotropic else table.x
    errors = table.errors
    return NdfOutput(
        target=table.target,
        linear_in=table.linear_in,
        segments=len(first.knots) - 1,
        mass=first.mass,
        total_variation=errors.total_variation if errors else None,
        masking=errors.masking if errors else None,
        directions=errors.directions if errors else None,
        knots=first.knots,
        values=first.values,
        across=None
        if isotropic
        else NdfProfile(mass=table.y.mass, knots=table.y.knots, values=table.y.values),
        checks=verified,
        costs=costs,
        files=files,
    )


def _costs(table: "NdfTable | NdfBlendTable") -> "list[NdfCost]":
    from coefficients.ndf_cost import ndf_costs
    from shadefit.material_outputs import NdfCost, NdfLookup

    return [
        NdfCost(
            function=each.name,
            operations=each.operations,
            rounding=each.rounding,
            axes=each.axes,
            textures=[NdfLookup(texels=one.texels, error=one.error) for one in each.lookups],
        )
        for each in ndf_costs(table)
    ]


def _print_costs(costs: "list[NdfCost]") -> None:
    from shadefit.terminal import print_table

    if not costs:
        return
    print_table(
        "Cost of the code, and textures that could stand for it",
        ["function", "operations", "error in float32", "texture over", "texels", "its error"],
        [
            [
                each.function,
                str(each.operations),
                f"{each.rounding:.1e}",
                each.axes or "none",
                ", ".join(str(one.texels) for one in each.textures),
                ", ".join(f"{one.error:.1e}" for one in each.textures),
            ]
            for each in costs
        ],
        "Textures are interpolated linearly. Errors are the largest at 6000 random points, against "
        "the code in float64.",
    )


def _print(table: "NdfTable | NdfBlendTable", verified: "list[NdfCheck]", files: list[str]) -> None:
    from coefficients.ndf_table import NdfTable
    from shadefit.terminal import print_lines, print_table

    profiles = [table] if isinstance(table, NdfTable) else [table.x, table.y]
    errors = table.errors
    knots = " and ".join(str(len(each.knots)) for each in profiles)
    compared = f" G1 at {errors.directions} directions." if errors else ""
    print_table(
        f"{table.target}, linear in {table.linear_in} between {knots} knots",
        ["mass of the interpolated", "total variation", "largest error of G1"],
        [
            [
                " and ".join(f"{each.mass:.4f}" for each in profiles),
                f"{errors.total_variation:.2e}" if errors else "not known",
                f"{errors.masking:.2e}" if errors else "not known",
            ]
        ],
        f"The mass is that of the source interpolated at these knots; that of the fit is 1."
        f"{compared}",
    )
    for each in verified:
        why = f": {each.reason}" if each.reason else ""
        print_lines(f"{each.function} in {each.language}: {each.status}{why}")
    for each in files:
        print_lines(each)


def _table(
    source: str,
    across: str | None,
    *,
    columns: tuple[str, str],
    degrees: bool,
    segments: int,
    linear_in: str,
    monotone: bool,
) -> "NdfTable | NdfBlendTable":
    """Return the table of a file, or that of a fit to what the sources name."""
    from coefficients.ndf_table import read_ndf

    path = Path(source)
    if path.suffix == ".json":
        if across is not None:
            raise ValueError("--across: allowed with a source that is fitted, not with a table")
        return read_ndf(path)
    from coefficients.ndf_record import table_of, table_of_blend, table_of_two
    from quantities.piecewise.blend_fit import fit_blend
    from quantities.piecewise.fit import fit_ndf
    from quantities.piecewise.targets import AnisotropicTarget

    targets = [
        _target(each, columns, degrees=degrees) for each in (source, across) if each is not None
    ]
    command = ["shadefit", "ndf", source]
    command += ["--across", across] if across is not None else []
    if any(_is_file(each) for each in (source, across) if each is not None):
        command += ["--theta", columns[0], "--value", columns[1]]
        command += ["--degrees"] if degrees else []
    command += ["--segments", str(segments), "--linear-in", linear_in]
    command += ["--monotone"] if monotone else []
    text = shlex.join(command)
    if isinstance(targets[0], AnisotropicTarget) and across is None:
        fit = fit_blend(targets[0], segments, variable=linear_in, monotone=monotone)
        return table_of_blend(fit, text)
    fits = []
    for each in targets:
        if isinstance(each, AnisotropicTarget):
            raise ValueError(f"--across with {each.name}: allowed are two isotropic sources")
        fits.append(fit_ndf(each, segments, variable=linear_in, monotone=monotone))
    return table_of(fits[0], text) if len(fits) == 1 else table_of_two(*fits, text)


def _target(
    source: str, columns: tuple[str, str], *, degrees: bool
) -> "Target | AnisotropicTarget":
    from quantities.piecewise.targets import measured_ndf, named_ndf

    if _is_file(source):
        return measured_ndf(Path(source), *columns, degrees=degrees)
    return named_ndf(source)


def _is_file(source: str) -> bool:
    return Path(source).exists() or Path(source).suffix in (".csv", ".npy", ".npz")
