"""`shadefit render`: a scene with exact functions and with tables, side by side, as PNG and EXR."""

from pathlib import Path
from typing import Annotated

import typer

from shadefit.commands.options import Json, angle


def render(
    scenes: Annotated[
        list[str] | None, typer.Argument(help="sphere, cloth; by default both.", metavar="SCENES")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("build/render"),
    density: Annotated[float, typer.Option(help="Density of the layer, 0 to 0.5.")] = 0.2,
    spread: Annotated[float, typer.Option(help="Spread of the lobe, (0, 1].")] = 0.2,
    tilt: Annotated[
        float, typer.Option(parser=angle, metavar="ANGLE", help="Polar angle of the fibres.")
    ] = "23deg",  # ty: ignore[invalid-parameter-default]
    fibers: Annotated[
        str, typer.Option(help="Where they lean: even, crushed, or a PNG map of directions.")
    ] = "crushed",
    fiber: Annotated[str, typer.Option(help="Colour of the fibres.")] = "#ff6f9c",
    base: Annotated[str, typer.Option(help="Colour of the base.")] = "#7a0f2b",
    sun: Annotated[float, typer.Option(help="Irradiance of the sun.")] = 7.0,
    sun_height: Annotated[
        float, typer.Option(parser=angle, metavar="ANGLE", help="Above the horizon.")
    ] = "40deg",  # ty: ignore[invalid-parameter-default]
    sun_azimuth: Annotated[
        float, typer.Option(parser=angle, metavar="ANGLE", help="From the right, anticlockwise.")
    ] = "215deg",  # ty: ignore[invalid-parameter-default]
    sky: Annotated[float, typer.Option(help="Radiance of the sky.")] = 1.2,
    size: Annotated[int, typer.Option(help="Pixels an edge, 16 to 1024.")] = 256,
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Draw the talk's sweeps instead: sweep.png.")
    ] = False,
    json: Json = False,
) -> None:
    """Render velvet with exact functions and with tables, side by side: render.png, render.exr."""
    from shadefit.render.compare import run
    from shadefit.render.settings import Settings

    settings = Settings(
        density, spread, tilt, fiber, base, sun, sun_height, sun_azimuth, sky, fibers, size
    )
    run(scenes or [], settings, out, sweep, json)
