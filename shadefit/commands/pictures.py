"""Commands that draw, render and report."""

from pathlib import Path
from typing import Annotated

import typer

from shadefit.options import Json, angle

app = typer.Typer()


@app.command("figures", epilog="Example: shadefit figures figure-5 frontier --out /tmp/figures")
def _figures(
    names: Annotated[
        list[str] | None, typer.Argument(help="Names of pictures; by default all.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("docs/figures"),
) -> None:
    """Draw the supplement's figures and ours, each as PNG and SVG."""
    from shadefit import figures

    figures.run(names or [], out)


@app.command(
    "render",
    epilog="Examples: shadefit render --density 0.1 --tilt 45deg; "
    "shadefit render cloth --sweep --fibers even --size 160",
)
def _render(
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
    from shadefit.render import compare as render

    settings = render.Settings(
        density, spread, tilt, fiber, base, sun, sun_height, sun_azimuth, sky, fibers, size
    )
    render.run(scenes or [], settings, out, sweep, json)


@app.command("report", epilog="Example: shadefit report --out /tmp/report.html")
def _report(
    out: Annotated[Path, typer.Option(help="The HTML file.")] = Path("build/report.html"),
) -> None:
    """Write one HTML file: tables and their worth, figures, errata, and an explorer."""
    from shadefit.report import page as report

    report.run(out)


@app.command("ambient", epilog="Example: shadefit ambient --out /tmp/figures")
def _ambient(
    out: Annotated[Path, typer.Option(help="Folder for ambient.png.")] = Path("docs/figures"),
    json: Json = False,
) -> None:
    """Measure the ambient model against the integral of the whole BRDF, and its energy."""
    from shadefit.ambient import command as ambient

    ambient.run(out, json)
