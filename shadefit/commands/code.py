"""Commands that write shader code, run it and count its operations."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from shadefit.completion import complete_language, complete_shader
from shadefit.options import Json

app = typer.Typer()


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
            autocompletion=complete_shader,
        ),
    ],
    to: Annotated[
        str | None,
        typer.Option(
            help="Language to write as code; by default JSON.",
            metavar="LANG",
            autocompletion=complete_language,
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
        typer.Argument(help="Tables' names or paths, exact/ps.", autocompletion=complete_shader),
    ],
    to: Annotated[
        str, typer.Option(help="Language, or all.", autocompletion=complete_language)
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
        typer.Argument(help="A table's name or path, or exact/ps.", autocompletion=complete_shader),
    ],
    throughput: Annotated[
        bool, typer.Option("--throughput", help="Measure compiled C against JAX.")
    ] = False,
    json: Json = False,
) -> None:
    """Count the operations of exported functions by kind, beside the closed form's."""
    from shadefit import cost

    cost.run(table, throughput, json)
