"""The command line `shadefit`: options and help here, the work in the modules beside it.

Those are imported when a command runs, so that help and completion do not wait for JAX.
"""

import os
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from shadefit.options import Json, angle

app = typer.Typer(
    name="shadefit",
    help="Exact shading integrals, certified curve fits, and coefficient tables.",
    epilog="Example: shadefit compare r",
    no_args_is_help=False,
    pretty_exceptions_enable=False,
)

_PUBLISHED = ("ps", "g", "q", "r")
_NAMES = (*_PUBLISHED, "velvet")


def _complete_quantity(incomplete: str) -> list[str]:
    return [name for name in (*_NAMES, "all") if name.startswith(incomplete)]


def _complete_table(incomplete: str) -> list[str]:
    best = (Path(__file__).parent.parent / "coefficients" / "best").glob("*.json")
    every = [*_NAMES, *(f"published/{name}" for name in _PUBLISHED)]
    every += sorted(f"best/{path.stem}" for path in best)
    return [name for name in every if name.startswith(incomplete)]


def _complete_shader(incomplete: str) -> list[str]:
    exact = [name for name in ("exact/ps",) if name.startswith(incomplete)]
    return [*_complete_table(incomplete), *exact]


def _complete_language(incomplete: str) -> list[str]:
    from coefficients.targets import TARGETS

    return [key for key in TARGETS if key.startswith(incomplete)]


def _print_version(wanted: bool | None) -> None:
    if wanted:
        print(f"shadefit {version('shadefit')}")
        raise typer.Exit


@app.callback()
def _global(
    _version: Annotated[
        bool | None,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = None,
) -> None:
    pass


_Norm = Annotated[
    Literal["l2", "linf"] | None,
    typer.Option(help="Least squares or least largest error; by default the table's own."),
]
_Side = Annotated[
    Literal["both", "below", "above"] | None,
    typer.Option(help="With linf, values never above (or below) the exact ones."),
]
_Rounding = Annotated[
    Literal["none", "float32", "float16"] | None,
    typer.Option(help="Precision that coefficients are rounded to, the others refitted in turn."),
]
_Relative = Annotated[bool, typer.Option("--relative", help="Make relative errors small.")]


@app.command(
    "refit",
    epilog="Examples: shadefit refit r g --out /tmp/tables --grid 33; "
    "shadefit refit best/q-9; shadefit refit g --norm linf --out /tmp/tables",
)
def _refit(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help="ps, g, q, r, velvet or all (the default); or best/NAME.",
            autocompletion=_complete_quantity,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for NAME.json; by default coefficients/refit or …/best."),
    ] = None,
    grid: Annotated[int, typer.Option(help="Nodes an axis, 9 to 129, for the paper's forms.")] = 65,
    weight: Annotated[
        Literal["uniform", "solid-angle", "cosine"],
        typer.Option(help="Measure of light directions in the fit of ps; the others have none."),
    ] = "uniform",
    norm: _Norm = None,
    side: _Side = None,
    rounding: _Rounding = None,
    relative: _Relative = False,
    json: Json = False,
) -> None:
    """Refit forms to exact values, the paper's or a best table's, and write the tables."""
    from shadefit import refit

    refit.run(names or [], out, grid, weight, _goal(norm, side, rounding, relative), json)


def _goal(norm, side, rounding, relative) -> dict[str, Any]:
    given = {"norm": norm, "side": side, "rounding": rounding, "relative": relative or None}
    return {key: value for key, value in given.items() if value is not None}


@app.command("search", epilog="Example: shadefit search q --budget 12 --max-error 2e-5")
def _search(
    quantity: Annotated[str, typer.Argument(help="ps, g, q or r.", metavar="QUANTITY")],
    budget: Annotated[
        int | None, typer.Option(help="Most operations a call (of P_s a direction).")
    ] = None,
    max_error: Annotated[
        float | None, typer.Option(help="Print only forms with no larger error.")
    ] = None,
    least_alpha: Annotated[
        float, typer.Option(help="Lower end of α in the fits of ps and r.")
    ] = 0.15,
    norm: _Norm = None,
    side: _Side = None,
    rounding: _Rounding = None,
    relative: _Relative = False,
    out: Annotated[
        Path, typer.Option(help="Folder for tables and plot; what is there is not fitted again.")
    ] = Path("search"),
    json: Json = False,
) -> None:
    """Fit families of forms, and print and plot operations against the largest error.

    By default the largest error is made least, with coefficients in float32.
    """
    from fitting import Goal
    from shadefit import search

    goal: dict[str, Any] = {"norm": "linf", "rounding": "float32"}
    goal |= _goal(norm, side, rounding, relative)
    search.run(quantity, budget, max_error, least_alpha, Goal(**goal), out, json)


@app.command("compare", epilog="Example: shadefit compare ps my/table.json --json")
def _compare(
    tables: Annotated[
        list[str] | None,
        typer.Argument(
            help="Names or paths; by default the refits of what is published.",
            autocompletion=_complete_table,
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Compare tables with the published ones, each against the exact integral."""
    from shadefit import compare

    compare.run(tables or [], json)


@app.command(
    "evaluate",
    epilog="Examples: shadefit evaluate ps --alpha 0.35 --theta-f 45deg --theta-u 30deg "
    "--phi 90deg; shadefit evaluate g --density 0.2 --cos-v 0.5",
)
def _evaluate(
    integral: Annotated[str, typer.Argument(help="ps, g, q, r or velvet.", metavar="INTEGRAL")],
    alpha: Annotated[
        float | None, typer.Option(help="Projected area along the fibre, (0, 1] (ps, r).")
    ] = None,
    theta_f: Annotated[
        float | None,
        typer.Option(parser=angle, metavar="ANGLE", help="Fibre's polar angle (ps, r)."),
    ] = None,
    theta_u: Annotated[
        float | None, typer.Option(parser=angle, metavar="ANGLE", help="Light's polar angle (ps).")
    ] = None,
    phi: Annotated[
        float | None,
        typer.Option(parser=angle, metavar="ANGLE", help="Light's azimuth from the fibre's (ps)."),
    ] = None,
    density: Annotated[
        float | None, typer.Option("--density", "--d", help="Density of the layer, d ≥ 0 (g, q).")
    ] = None,
    cos_v: Annotated[
        float | None, typer.Option("--cos-v", "--nu", help="Cosine of view and normal, v·n (g).")
    ] = None,
    asymmetry: Annotated[
        float | None,
        typer.Option("--asymmetry", "--k", help="Asymmetry of Schlick's lobe, (−1, 0] (velvet)."),
    ] = None,
    samples: Annotated[int, typer.Option(help="Monte Carlo samples.")] = 1 << 16,
    sequence: Annotated[
        Literal["random", "sobol"], typer.Option(help="Monte Carlo points.")
    ] = "random",
    seed: Annotated[int, typer.Option(help="Monte Carlo seed.")] = 0,
    json: Json = False,
) -> None:
    """Evaluate an integral by every leg, and by the published and refitted tables.

    Angles are radians unless 'deg' follows: 45deg, 0.785, 0.785rad.
    """
    from shadefit import evaluate

    given = {
        "alpha": alpha,
        "theta_f": theta_f,
        "theta_u": theta_u,
        "phi": phi,
        "density": density,
        "cos_v": cos_v,
        "asymmetry": asymmetry,
    }
    evaluate.run(integral, given, samples, sequence, seed, json)


@app.command(
    "export",
    epilog="Examples: shadefit export published/ps -o ps.json; "
    "shadefit export exact/ps --to hlsl --precision half",
)
def _export(
    table: Annotated[
        str,
        typer.Argument(
            help="A table's name or path; with --to, also exact/ps.",
            autocompletion=_complete_shader,
        ),
    ],
    to: Annotated[
        str | None,
        typer.Option(
            help="Language to write as code; by default JSON.",
            metavar="LANG",
            autocompletion=_complete_language,
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File; by default standard output.")
    ] = None,
    precision: Annotated[
        Literal["half", "float", "double"] | None,
        typer.Option(help="By default float (JavaScript: double)."),
    ] = None,
    name: Annotated[
        str | None, typer.Option(help="Name of the function; by default the paper's.")
    ] = None,
    constants: Annotated[
        Literal["inline", "table"] | None,
        typer.Option(help="Where the constants stand; by default inline."),
    ] = None,
) -> None:
    """Write a table's validated JSON, or its functions as code in a language.

    The code is run where its compiler is here, and headed by its measured error.
    """
    from shadefit import export

    export.run(table, output, to, precision, name, constants)


@app.command("verify", epilog="Example: shadefit verify ps exact/ps --to wgsl --precision all")
def _verify(
    tables: Annotated[
        list[str],
        typer.Argument(help="Tables' names or paths, exact/ps.", autocompletion=_complete_shader),
    ],
    to: Annotated[
        str, typer.Option(help="Language, or all.", autocompletion=_complete_language)
    ] = "all",
    precision: Annotated[
        Literal["half", "float", "double", "all"] | None,
        typer.Option(help="By default float (JavaScript: double)."),
    ] = None,
    json: Json = False,
) -> int:
    """Compile and run exported code, and compare it with its form and the exact integral.

    Exit status 1 if any language failed. A compiler that is not here is 'not checked'.
    """
    from shadefit import verify

    return verify.run(tables, to, precision, json)


@app.command("cost", epilog="Example: shadefit cost ps --throughput")
def _cost(
    table: Annotated[
        str,
        typer.Argument(
            help="A table's name or path, or exact/ps.", autocompletion=_complete_shader
        ),
    ],
    throughput: Annotated[
        bool, typer.Option("--throughput", help="Measure compiled C against JAX.")
    ] = False,
    json: Json = False,
) -> None:
    """Count the operations of exported functions by kind, beside the closed form's."""
    from shadefit import cost

    cost.run(table, throughput, json)


@app.command("figures", epilog="Example: shadefit figures figure-5 frontier --out /tmp/figures")
def _figures(
    names: Annotated[
        list[str] | None, typer.Argument(help="Names of pictures; by default all.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("docs/figures"),
) -> None:
    """Draw the supplement's figures and ours, each as PNG and SVG."""
    from shadefit import figures

    figures.run(names or [], out)


@app.command(
    "render",
    epilog="Examples: shadefit render --density 0.1 --tilt 45deg; "
    "shadefit render cloth --sweep --fibers even --size 160",
)
def _render(
    scenes: Annotated[
        list[str] | None, typer.Argument(help="sphere, cloth; by default both.", metavar="SCENES")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("build/render"),
    density: Annotated[float, typer.Option(help="Density of the layer, 0 to 0.5.")] = 0.2,
    spread: Annotated[float, typer.Option(help="Spread of the lobe, (0, 1].")] = 0.2,
    tilt: Annotated[
        float, typer.Option(parser=angle, metavar="ANGLE", help="Polar angle of the fibres.")
    ] = "23deg",  # ty: ignore[invalid-parameter-default]
    fibers: Annotated[
        str, typer.Option(help="Where they lean: even, crushed, or a PNG map of directions.")
    ] = "crushed",
    fiber: Annotated[str, typer.Option(help="Colour of the fibres.")] = "#ff6f9c",
    base: Annotated[str, typer.Option(help="Colour of the base.")] = "#7a0f2b",
    sun: Annotated[float, typer.Option(help="Irradiance of the sun.")] = 7.0,
    sun_height: Annotated[
        float, typer.Option(parser=angle, metavar="ANGLE", help="Above the horizon.")
    ] = "40deg",  # ty: ignore[invalid-parameter-default]
    sun_azimuth: Annotated[
        float, typer.Option(parser=angle, metavar="ANGLE", help="From the right, anticlockwise.")
    ] = "215deg",  # ty: ignore[invalid-parameter-default]
    sky: Annotated[float, typer.Option(help="Radiance of the sky.")] = 1.2,
    size: Annotated[int, typer.Option(help="Pixels an edge, 16 to 1024.")] = 256,
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Draw the talk's sweeps instead: sweep.png.")
    ] = False,
    json: Json = False,
) -> None:
    """Render velvet with exact functions and with tables, side by side: render.png, render.exr."""
    from shadefit import render

    settings = render.Settings(
        density, spread, tilt, fiber, base, sun, sun_height, sun_azimuth, sky, fibers, size
    )
    render.run(scenes or [], settings, out, sweep, json)


@app.command("report", epilog="Example: shadefit report --out /tmp/report.html")
def _report(
    out: Annotated[Path, typer.Option(help="The HTML file.")] = Path("build/report.html"),
) -> None:
    """Write one HTML file: tables and their worth, figures, errata, and an explorer."""
    from shadefit import report

    report.run(out)


@app.command("ambient", epilog="Example: shadefit ambient --out /tmp/figures")
def _ambient(
    out: Annotated[Path, typer.Option(help="Folder for ambient.png.")] = Path("docs/figures"),
    json: Json = False,
) -> None:
    """Measure the ambient model against the integral of the whole BRDF, and its energy."""
    from shadefit import ambient

    ambient.run(out, json)


@app.command("list", epilog="Example: shadefit list --json")
def _list(json: Json = False) -> None:
    """List the tables that have a name."""
    from shadefit import tables

    tables.list_tables(json)


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; exit status 2 with one line on standard error for bad input."""
    os.environ.setdefault("JAX_ENABLE_X64", "1")
    # One thread: more would change the order of sums, and so the last digits, with the machine.
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    given = sys.argv[1:] if arguments is None else arguments
    try:
        status = app(given or ["--help"], standalone_mode=False)
    except (typer.TyperException, ValueError) as error:
        message = error.format_message() if isinstance(error, typer.TyperException) else str(error)
        _fail(message, 2)
    except (typer.Abort, KeyboardInterrupt):
        print("shadefit: interrupted; no table was written", file=sys.stderr, flush=True)
        # At once: leaving in the ordinary way would wait for compilations to end.
        os._exit(130)
    except BrokenPipeError:
        # The reader of our output has gone: not an error, but Python would complain at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    sys.exit(status or 0)


def _fail(message: str, status: int) -> None:
    print(f"shadefit: {' '.join(message.split())}", file=sys.stderr)
    sys.exit(status)
