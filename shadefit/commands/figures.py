"""`shadefit figures`: draw the figures of the supplement, and further pictures."""

import sys
from pathlib import Path
from typing import Annotated

import typer


def figures(
    names: Annotated[
        list[str] | None,
        typer.Argument(help="Names of pictures; by default all whose libraries are installed."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("build/figures"),
) -> None:
    """Draw pictures as PNG and SVG: the figures of the supplement, errors, and costs."""
    from coefficients.files import require_writable, write_whole_bytes
    from shadefit.figures import drawable, pictures, render, require_libraries
    from shadefit.memory import give_back
    from shadefit.progress import stages
    from shadefit.terminal import print_lines

    known = pictures()
    for name in names or []:
        if name not in known:
            raise ValueError(f"no figure is called {name!r}: allowed are {', '.join(known)}")
        require_libraries(known[name])
    require_writable(out)
    chosen, files = list(names or []), []
    if not chosen:
        known, absent = drawable(known)
        chosen = list(known)
        print(*absent, sep="\n", end="\n" if absent else "", file=sys.stderr)
    with stages() as progress:
        stage = progress.begin("", total=len(chosen))
        for name in chosen:
            stage.show(name)
            for extension, data in render(known[name].draw).items():
                path = out / f"{name}.{extension}"
                write_whole_bytes(path, data)
                files.append(path)
            give_back()
            stage.advance()
    print_lines(*files)
