"""`shadefit ambient`: what the ambient model's approximations cost, as tables and a picture."""

from pathlib import Path
from typing import Annotated

import typer

from shadefit.commands.options import Json


def ambient(
    out: Annotated[Path, typer.Option(help="Folder for ambient.png.")] = Path("docs/figures"),
    json: Json = False,
) -> None:
    """Measure the ambient model against the integral of the whole BRDF, and its energy."""
    from shadefit.ambient.command import run

    run(out, json)
