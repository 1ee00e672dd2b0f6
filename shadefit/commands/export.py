"""`shadefit export`: write a table as JSON, or as shader code with a header that states errors."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from shadefit.commands.names import require_tables
from shadefit.completion import complete_language, complete_shader


def export(
    table: Annotated[
        str,
        typer.Argument(
            help="Name or path of a table; with --to also exact/NAME, a closed form.",
            autocompletion=complete_shader,
        ),
    ],
    to: Annotated[
        str | None,
        typer.Option(
            help="Language of the code; without this option JSON is written.",
            metavar="LANG",
            autocompletion=complete_language,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="File to write; by default standard output."),
    ] = None,
    precision: Annotated[
        str | None,
        typer.Option(help="half, float or double; by default float, for JavaScript double."),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(help="Name of the function; by default that of the paper's listing."),
    ] = None,
    constants: Annotated[
        Literal["inline", "table"] | None,
        typer.Option(help="Where the code has its constants; by default inline."),
    ] = None,
) -> None:
    """Write a table as JSON, or as code in a language.

    The code is run if its compiler is installed. Its header states the error
    that was measured.
    """
    require_tables([table])
    if to is not None:
        from programs.languages import language

        language(to)
    from coefficients.catalogue import resolve
    from coefficients.exported_code import source_file
    from coefficients.files import require_writable_file, write_whole
    from coefficients.table import serialise
    from shadefit.encoding import shown_json

    if output is not None:
        require_writable_file(output)
    if to is None:
        for option, given in (
            ("--precision", precision),
            ("--name", name),
            ("--constants", constants),
        ):
            if given is not None:
                raise ValueError(f"{option} {given!r} is for code: allowed with --to LANG")
        text = serialise(resolve(table).require_table())
    else:
        text = source_file(resolve(table), to, precision, name, constants or "inline")
    if output is None:
        print(text if to else shown_json(text), end="")
    else:
        write_whole(output, text)
