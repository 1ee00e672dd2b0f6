"""`shadefit maps`: filter maps of anisotropic GGX lobes, and measure filters on synthetic maps."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from shadefit.commands.options import Json

maps = typer.Typer(help="Filter and encode maps of normals and anisotropic GGX roughness.")
_Method = Literal["naive", "clean", "lean", "sggx", "estimated", "fitted", "kl"]


@maps.command(
    "filter",
    epilog="Examples: shadefit maps filter normal.png roughness.png --colour-space linear "
    "--convention opengl --out /tmp/chain; shadefit maps filter n.exr r.exr --direction t.exr "
    "--colour-space linear --convention directx --method sggx --format exr",
)
def filter_files(
    normals: Annotated[Path, typer.Argument(help="Normal map: PNG, EXR or DDS.")],
    roughness: Annotated[
        Path,
        typer.Argument(help="Roughness map: one channel, or along and across the direction."),
    ],
    convention: Annotated[
        Literal["opengl", "directx"],
        typer.Option(help="Whether y points up (opengl) or down (directx) in the pictures."),
    ],
    colour_space: Annotated[
        str | None, typer.Option(help="What the values in the files are: linear.")
    ] = None,
    direction: Annotated[
        Path | None, typer.Option(help="Map of the tangent's direction; by default it is x.")
    ] = None,
    widths: Annotated[
        Literal["alpha", "perceptual"],
        typer.Option(help="Whether roughness is the width α of GGX, or perceptual (its root)."),
    ] = "alpha",
    vectors: Annotated[
        Literal["unsigned", "signed"] | None,
        typer.Option(help="How vectors are stored; by default signed in EXR, unsigned in others."),
    ] = None,
    method: Annotated[_Method, typer.Option(help="Filter.")] = "kl",
    block: Annotated[
        int, typer.Option(help="Texels that are processed at once; it bounds the memory.")
    ] = 1 << 18,
    format: Annotated[
        Literal["png", "exr"], typer.Option(help="Format of the files: 16 bits, or float32.")
    ] = "png",
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("build/maps"),
    json: Json = False,
) -> None:
    """Filter maps of normals and roughness into a whole mip chain, and write its levels."""
    from coefficients.files import require_writable
    from shadefit.maps.files import read_lobe_map, write_chain
    from shadefit.maps.filters import filter_chain
    from shadefit.material_outputs import MapLevel, MapsFilterOutput
    from shadefit.progress import stages
    from shadefit.terminal import print_json, print_table

    require_writable(out)
    base = read_lobe_map(
        normals,
        roughness,
        direction,
        colour_space=colour_space,
        convention=convention,
        widths=widths,
        vectors=vectors,
    )
    with stages() as progress:
        line = progress.begin(f"{method}: texels", total=base.size[0] * base.size[1])
        levels = filter_chain(
            base,
            method,
            block=block,
            progress=lambda done, total: line.show(f"{method}: texels", done, total),
        )
        progress.begin("files")
        paths = write_chain(levels, out, format, convention)
    report = MapsFilterOutput(
        method=method,
        convention=convention,
        levels=[
            MapLevel(width=each.size[1], height=each.size[0], normal=str(normal), aniso=str(aniso))
            for each, (normal, aniso) in zip(levels, paths, strict=True)
        ],
    )
    if json:
        print_json(report)
        return
    print_table(
        f"{method}: a mip chain",
        ["level", "size", "normals", "roughness"],
        [
            [str(k), f"{each.width} × {each.height}", each.normal, each.aniso]
            for k, each in enumerate(report.levels)
        ],
    )


@maps.command(
    "errors", epilog="Example: shadefit maps errors weave weak-bumps --footprints 8 --json"
)
def errors(
    names: Annotated[
        list[str] | None, typer.Argument(help="Synthetic maps; by default all.", metavar="MAP...")
    ] = None,
    footprints: Annotated[
        int, typer.Option(help="Footprints of 16 × 16 texels that are measured, 1 to 16.")
    ] = 8,
    seed: Annotated[int, typer.Option(help="Seed of the maps and of the choice.", min=0)] = 1,
    json: Json = False,
) -> None:
    """Measure the filters on synthetic maps, against the mean of the texels' lobes."""
    from shadefit.maps.errors import filter_errors
    from shadefit.maps.filters import FILTERS
    from shadefit.maps.synthetic import MAPS
    from shadefit.material_outputs import MapErrors, MapsErrorsOutput
    from shadefit.progress import stages
    from shadefit.terminal import print_json, print_table

    chosen = list(dict.fromkeys(names or MAPS))
    for name in chosen:
        if name not in MAPS:
            raise ValueError(f"map {name!r} is not known: allowed are {', '.join(MAPS)}")
    with stages() as progress:
        line = progress.begin("maps", total=len(chosen))
        found = filter_errors(
            chosen,
            footprints=footprints,
            seed=seed,
            progress=lambda done, total: line.show("maps", done, total),
        )
    if json:
        print_json(
            MapsErrorsOutput(
                footprints=footprints,
                seed=seed,
                errors=[
                    MapErrors(
                        map=each.map,
                        method=each.method,
                        total_variation=each.total_variation,
                        radiance=each.radiance,
                    )
                    for each in found
                ],
            )
        )
        return
    by = {(each.map, each.method): each for each in found}
    methods = [*FILTERS, "best"]
    print_table(
        "Total variation of the normals / rms error of the radiance by its mean",
        ["map", *methods],
        [
            [
                name,
                *(
                    f"{by[name, each].total_variation:.3f} / {by[name, each].radiance:.2f}"
                    for each in methods
                ),
            ]
            for name in chosen
        ],
    )
