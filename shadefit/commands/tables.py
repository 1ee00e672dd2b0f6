"""Commands that make tables and tell what they are worth."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from shadefit.completion import complete_quantity, complete_table
from shadefit.options import Json, angle

app = typer.Typer()

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
_Bounded = Annotated[
    bool, typer.Option("--bounded", help="With linf, values between 0 and 1, and proven to be.")
]


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
            autocompletion=complete_quantity,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for NAME.json; by default the table is replaced."),
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
    bounded: _Bounded = False,
    json: Json = False,
) -> None:
    """Refit forms to exact values, the paper's or a best table's, and write the tables."""
    from shadefit import refit

    refit.run(names or [], out, grid, weight, _goal(norm, side, rounding, relative, bounded), json)


def _goal(norm, side, rounding, relative, bounded) -> dict[str, Any]:
    given = {
        "norm": norm,
        "side": side,
        "rounding": rounding,
        "relative": relative or None,
        "bounded": bounded or None,
    }
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
    bounded: _Bounded = False,
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
    goal |= _goal(norm, side, rounding, relative, bounded)
    search.run(quantity, budget, max_error, least_alpha, Goal(**goal), out, json)


@app.command("compare", epilog="Example: shadefit compare ps my/table.json --json")
def _compare(
    tables: Annotated[
        list[str] | None,
        typer.Argument(
            help="Names or paths; by default the refits of what is published.",
            autocompletion=complete_table,
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
        float | None,
        typer.Option(help="Roughness: projected area along the fibre, (0, 1] (ps, r)."),
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
        typer.Option(
            parser=angle, metavar="ANGLE", help="Light's azimuth relative to the fibre (ps)."
        ),
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
    table: Annotated[
        list[str] | None,
        typer.Option(
            help="A further table's name or path; may be given again.",
            autocompletion=complete_table,
        ),
    ] = None,
    samples: Annotated[int, typer.Option(help="Monte Carlo samples.")] = 1 << 16,
    sequence: Annotated[
        Literal["random", "sobol"], typer.Option(help="Monte Carlo points.")
    ] = "random",
    seed: Annotated[int, typer.Option(help="Monte Carlo seed.")] = 0,
    json: Json = False,
) -> None:
    """Evaluate an integral by every leg, by the published and refitted tables, and by others.

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
    evaluate.run(integral, given, table or [], samples, sequence, seed, json)


@app.command("list", epilog="Example: shadefit list --json")
def _list(json: Json = False) -> None:
    """List the tables that have a name."""
    from shadefit import tables

    tables.list_tables(json)
