"""`shadefit report`: write one HTML file with tables of errors, all figures, and an explorer."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.names import require_tables
from shadefit.completion import complete_table

if TYPE_CHECKING:
    from coefficients.catalogue import Entry


def report(
    tables: Annotated[
        list[str] | None,
        typer.Argument(
            help="Paths of tables to show beside the packaged ones; their quantities by -p.",
            autocompletion=complete_table,
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="HTML file to write.")] = Path("build/report.html"),
) -> None:
    """Write one HTML file: errors and costs of all tables, figures, errata, and an explorer."""
    require_tables(tables or [])
    from coefficients.files import require_writable_file, write_whole
    from shadefit.figures import drawable, pictures, render
    from shadefit.progress import stages
    from shadefit.report.page import page
    from shadefit.terminal import apart_from, print_lines

    require_writable_file(out)
    more = _more(tables or [])
    drawn = {}
    known, absent = drawable(pictures())
    print(*absent, sep="\n", end="\n" if absent else "", file=sys.stderr)
    with stages() as progress:
        stage = progress.begin("", total=len(known) + 1)
        for name, picture in known.items():
            stage.show(name)
            drawn[name] = render(picture.draw)["png"]
            stage.advance()
        stage.show("tables")
        write_whole(out, page(drawn, more))
    with apart_from(out):
        print_lines(out)


def _more(names: list[str]) -> "list[Entry]":
    """Return the entries of tables that are not packaged, each once.

    Raises ValueError for a closed form, and for a table of a quantity that is not known.
    """
    from coefficients.catalogue import entries, resolve
    from quantities import problems

    known = {entry.name for entry in entries()}
    found = [resolve(name) for name in dict.fromkeys(names) if name not in known]
    for entry in found:
        table = entry.require_table()
        if entry.problem not in problems().values():
            raise ValueError(
                f"{entry.name} is a table of {table.quantity!r}, which is not known: allowed are "
                f"tables of {', '.join(problems())}, and of a quantity that -p FILE declares"
            )
    return found
