"""`shadefit report`: write one HTML file with tables of errors, all figures, and an explorer."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.names import require_tables
from shadefit.completion import complete_table

if TYPE_CHECKING:
    from coefficients.catalogue import Entry

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# In bytes
_LARGEST_PICTURE = 1 << 24


def report(
    tables: Annotated[
        list[str] | None,
        typer.Argument(
            help="Paths of tables to show beside the packaged ones; their quantities by -p.",
            autocompletion=complete_table,
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="HTML file to write.")] = Path("build/report.html"),
    pictures: Annotated[
        Path | None,
        typer.Option(
            help="Folder of pictures that 'shadefit figures --out' drew: NAME.png is taken from "
            "there as it is, and only what is not there is drawn.",
            metavar="FOLDER",
        ),
    ] = None,
) -> None:
    """Write one HTML file: errors and costs of all tables, figures, errata, and an explorer."""
    require_tables(tables or [])
    from coefficients.files import require_writable_file, write_whole
    from shadefit.figures import drawable, render
    from shadefit.figures import pictures as every_picture
    from shadefit.memory import give_back
    from shadefit.progress import stages
    from shadefit.report.page import page
    from shadefit.terminal import messages_beside, print_lines

    require_writable_file(out)
    more = _more(tables or [])
    known = every_picture()
    taken = {} if pictures is None else _taken(pictures, list(known))
    missing = {name: each for name, each in known.items() if name not in taken}
    missing, absent = drawable(missing)
    print(*absent, sep="\n", end="\n" if absent else "", file=sys.stderr)
    with stages() as progress:
        stage = progress.begin("", total=len(missing) + 1)
        for name, picture in missing.items():
            stage.show(name)
            taken[name] = render(picture.draw, ["png"])["png"]
            give_back()
            stage.advance()
        stage.show("tables")
        drawn = {name: taken[name] for name in known if name in taken}
        write_whole(out, page(drawn, more))
    with messages_beside(out):
        print_lines(out)


def _taken(folder: Path, names: list[str]) -> dict[str, bytes]:
    """Return the PNG files of pictures that are in a folder, by the names of the pictures.

    Raises ValueError if it is no folder, and for a file that is no PNG file.
    """
    from coefficients.input_files import read_bounded

    if not folder.is_dir():
        raise ValueError(f"--pictures {folder}: allowed is a folder of pictures")
    found = {}
    for name in names:
        path = folder / f"{name}.png"
        if path.exists():
            found[name] = read_bounded(path, _LARGEST_PICTURE)
            if not found[name].startswith(_SIGNATURE):
                raise ValueError(f"{path} is no picture: allowed are PNG files")
    return found


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
