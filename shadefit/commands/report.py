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
    from shadefit.report.page import page
    from shadefit.terminal import stages

    require_writable_file(out)
    drawn = {}
    with stages() as progress:
        task = progress.add_task("")
        for name, picture in pictures().items():
            progress.update(task, description=name)
            drawn[name] = render(picture.draw)["png"]
        progress.update(task, description="tables")
        write_whole(out, page(drawn))
    print(out)
