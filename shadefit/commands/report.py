"""`shadefit report`: write one HTML file with tables of errors, all figures, and an explorer."""

from pathlib import Path
from typing import Annotated

import typer


def report(
    out: Annotated[Path, typer.Option(help="HTML file to write.")] = Path("build/report.html"),
) -> None:
    """Write one HTML file: errors and costs of all tables, figures, errata, and an explorer."""
    from coefficients.files import require_writable_file, write_whole
    from shadefit.figures import pictures, render
    from shadefit.progress import stages
    from shadefit.report.page import page

    require_writable_file(out)
    drawn = {}
    with stages() as progress:
        known = pictures()
        stage = progress.begin("", total=len(known) + 1)
        for name, picture in known.items():
            stage.show(name)
            drawn[name] = render(picture.draw)["png"]
            stage.advance()
        stage.show("tables")
        write_whole(out, page(drawn))
    print(out)
