"""`shadefit render`: render scenes with exact functions and with tables, as PNG and EXR."""

import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json, angle, checked

if TYPE_CHECKING:
    from shadefit.render.scenes import Scene
    from shadefit.render.settings import Settings


def render(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(help="sphere or cloth; by default both.", metavar="SCENES"),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("build/render"),
    density: Annotated[float, typer.Option(help="Density of the layer, 0 to 0.5.")] = 0.2,
    spread: Annotated[
        float, typer.Option(help="Spread of the fibres' lobe, above 0, to 1: the square of alpha.")
    ] = 0.2,
    tilt: Annotated[
        float, typer.Option(parser=angle, metavar="ANGLE", help="Polar angle of the fibres.")
    ] = "23deg",  # ty: ignore[invalid-parameter-default]
    fibers: Annotated[
        str,
        typer.Option(help="Where fibres lean: even, crushed, or a PNG file with a direction map."),
    ] = "crushed",
    fiber: Annotated[str, typer.Option(help="Colour of the fibres, #rrggbb.")] = "#ff6f9c",
    base: Annotated[str, typer.Option(help="Colour of the base, #rrggbb.")] = "#7a0f2b",
    sun: Annotated[float, typer.Option(help="Irradiance of the sun.")] = 7.0,
    sun_height: Annotated[
        float,
        typer.Option(parser=angle, metavar="ANGLE", help="Angle of the sun above the horizon."),
    ] = "40deg",  # ty: ignore[invalid-parameter-default]
    sun_azimuth: Annotated[
        float,
        typer.Option(
            parser=angle,
            metavar="ANGLE",
            help="Azimuth of the sun, anticlockwise from the right of the image.",
        ),
    ] = "215deg",  # ty: ignore[invalid-parameter-default]
    sky: Annotated[float, typer.Option(help="Radiance of the sky.")] = 1.2,
    size: Annotated[
        int, typer.Option(help="Width and height of a compared image in pixels, 16 to 1024.")
    ] = 256,
    sweep: Annotated[
        bool,
        typer.Option(
            "--sweep", help="Draw many densities, spreads and tilts, as in the talk: sweep.png."
        ),
    ] = False,
    json: Json = False,
) -> None:
    """Render velvet with exact functions and with tables, and show their differences.

    The files are render.png, which shows the last scene large, and render.exr with every image.
    """
    from shadefit.render.settings import Settings

    settings = Settings(
        density, spread, tilt, fiber, base, sun, sun_height, sun_azimuth, sky, fibers, size
    )
    run(scenes or [], settings, out, sweep, json)


def run(names: list[str], settings: "Settings", out: Path, sweep: bool, json: bool) -> None:
    """Render scenes, by default all, and write `render.png` and `render.exr`, or `sweep.png`.

    Raises ValueError for a setting outside its domain, an unknown scene, and several scenes with
    `sweep`; no file is written then.
    """
    from coefficients.files import require_writable
    from shadefit.render.scenes import SCENES

    check_settings(settings)
    unknown = [name for name in names if name not in SCENES]
    if unknown:
        raise ValueError(f"scene is {unknown[0]!r}; allowed: {', '.join(SCENES)}")
    require_writable(out)
    if sweep:
        if len(names) > 1:
            raise ValueError(f"scenes are {', '.join(names)}; allowed with --sweep: one")
        _write_sweep(SCENES[names[0] if names else "cloth"], settings, out, json)
    else:
        _write_comparisons([SCENES[name] for name in names or SCENES], settings, out, json)


def check_settings(settings: "Settings") -> None:
    """Raise ValueError for the first setting that is outside its domain or cannot be read."""
    from math import pi

    from integrals import PS, Axis

    domains = (
        Axis("density", 0.0, 0.5, "d", meaning="density of the layer"),
        Axis("spread", 0.0, 1.0, meaning="spread of the lobe", open_below=True),
        Axis("tilt", 0.0, PS.axes[1].upper, "θf", "rad", "polar angle of the fibres"),
        Axis("sun_height", 0.0, pi / 2, "", "rad", "height of the sun above the horizon"),
        Axis("sun_azimuth", -2 * pi, 2 * pi, "", "rad", "the sun's azimuth from the right"),
        Axis("sun", 0.0, 1e3, meaning="irradiance of the sun"),
        Axis("sky", 0.0, 1e3, meaning="radiance of the sky"),
        Axis("size", 16.0, 1024.0, meaning="pixels an edge"),
    )
    for axis in domains:
        checked(axis, _number(getattr(settings, axis.name)))
    # Making the material reads the colours, and raises ValueError for one that cannot be read.
    _ = settings.material


def _number(value: float | int) -> float:
    """Return a number as a float; an integer that is too large for one is infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _write_sweep(scene: "Scene", settings: "Settings", out: Path, json: bool) -> None:
    from coefficients.files import write_whole_bytes
    from shadefit.outputs import RenderOutput
    from shadefit.progress import stages
    from shadefit.render.sweep import draw_sweep
    from shadefit.terminal import print_json, print_lines

    path = out / "sweep.png"
    with stages() as progress:
        stage = progress.begin(scene.name)
        made = draw_sweep(scene, settings, partial(stage.show, scene.name))
    write_whole_bytes(path, made)
    if json:
        print_json(RenderOutput(files=[str(path)], images=[]))
    else:
        print_lines(path)


def _write_comparisons(scenes: "list[Scene]", settings: "Settings", out: Path, json: bool) -> None:
    from coefficients.files import write_whole_bytes
    from coefficients.textures.exr import write_exr
    from shadefit.memory import give_back
    from shadefit.outputs import RenderOutput
    from shadefit.progress import stages
    from shadefit.render.comparison import compare, exr_channels
    from shadefit.render.functions import EXACT
    from shadefit.render.image import render_large
    from shadefit.render.sheet import draw_comparisons
    from shadefit.terminal import print_json, print_table

    comparisons = []
    with stages() as progress:
        for scene in scenes:
            stage = progress.begin(scene.name)
            comparisons.append(compare(scene, settings, partial(stage.show, scene.name)))
            stage.end()
        text = f"{scenes[-1].name}, large"
        stage = progress.begin(text)
        large = render_large(scenes[-1], settings, EXACT, partial(stage.show, text))
        stage.end()
    sheet, exr = out / "render.png", out / "render.exr"
    # Nothing is compiled from here on.
    give_back(kept_below=0)
    # Each takes much memory, and gives it back.
    write_whole_bytes(exr, write_exr(exr_channels(comparisons)))
    write_whole_bytes(sheet, draw_comparisons(comparisons, large))
    rows = [row for comparison in comparisons for row in comparison.statistics()]
    if json:
        files = [str(sheet), str(exr)]
        print_json(RenderOutput.model_validate({"files": files, "images": rows}))
        return
    print_table(
        "Luminance against the image with exact functions",
        ["scene", "tables", "mean luminance", "rms difference", "largest"],
        [
            [row["scene"], row["tables"], *(f"{row[key]:.2e}" for key in ("mean", "rms", "max"))]
            for row in rows
        ],
        f"{sheet}, and linear in {exr}.",
    )
