"""`shadefit figures`: draw the figures of the supplement, and further pictures."""

from pathlib import Path
from typing import Annotated

import typer


def figures(
    names: Annotated[
        list[str] | None, typer.Argument(help="Names of pictures; by default all.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("build/figures"),
) -> None:
    """Draw pictures as PNG and SVG: the figures of the supplement, errors, and costs."""
    from coefficients.files import require_writable, write_whole_bytes
    from shadefit.figures import pictures, render
    from shadefit.progress import stages

    known = pictures()
    for name in names or []:
        if name not in known:
            raise ValueError(f"no figure is called {name!r}: allowed are {', '.join(known)}")
    require_writable(out)
    chosen, files = list(names or known), []
    with stages() as progress:
        stage = progress.begin("", total=len(chosen))
        for name in chosen:
            stage.show(name)
            for extension, data in render(known[name].draw).items():
                path = out / f"{name}.{extension}"
                write_whole_bytes(path, data)
                files.append(path)
            stage.advance()
    print(*files, sep="\n")
