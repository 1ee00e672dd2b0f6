"""`shadefit maps encode`: write a map of anisotropic roughness as a texture with mip levels."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from shadefit.commands.options import Json

if TYPE_CHECKING:
    from shadefit.maps.aniso_map import EncodedLevel


def encode(
    alpha_t: Annotated[
        Path, typer.Argument(help="Image of the roughness αt along the direction, in [0, 1].")
    ],
    alpha_b: Annotated[Path, typer.Argument(help="Image of the roughness αb across it.")],
    direction: Annotated[
        Path,
        typer.Argument(
            help="Image of the direction: its angle to the tangent, where 1 is half a turn."
        ),
    ],
    encoding: Annotated[
        Literal["published", "stereographic", "quarter-root", "logarithmic"],
        typer.Option(help="How three channels hold the matrix."),
    ] = "quarter-root",
    format: Annotated[
        Literal["bc7", "bc1", "rgba8"], typer.Option(help="Format of the texels.")
    ] = "bc7",
    mips: Annotated[
        bool, typer.Option(help="Whether to write mip levels; their normals count as equal.")
    ] = True,
    out: Annotated[Path, typer.Option("-o", "--out", help="DDS file to write.")] = Path(
        "aniso.dds"
    ),
    json: Json = False,
) -> None:
    """Encode roughness and its direction as a texture, and print what compression costs.

    The images are PNG, EXR or DDS files of one channel with linear values, not
    sRGB. A roughness below 0.01 is raised to 0.01, as decoders do. Errors are
    total variations between the GGX lobe of a texel and the one that a shader
    decodes. The shader code is that of decode/aniso-ENCODING.
    """
    import numpy as np

    from coefficients.files import require_writable_file, write_whole_bytes
    from shadefit.images.image import (
        bands,
        require_channels,
        require_power_of_two,
        require_same_size,
    )
    from shadefit.images.reading import read_image
    from shadefit.maps.aniso_map import encode_level, mip_entries, write_map
    from shadefit.material_outputs import MapsEncodeOutput
    from shadefit.terminal import print_json
    from shading.maps.encode import entries_of_widths
    from shading.maps.encodings import LEAST_ALPHA

    require_writable_file(out)
    if out.suffix.lower() != ".dds":
        raise ValueError(f"{out}: allowed is a file .dds")
    images = [read_image(path, "linear") for path in (alpha_t, alpha_b, direction)]
    for image in images:
        require_channels(image, 1)
        require_same_size(images[0], image)
        if image.pixels.min() < 0 or image.pixels.max() > 1:
            raise ValueError(f"{image.name}: a value is outside [0, 1]: allowed is [0, 1]")
    if mips:
        require_power_of_two(images[0])
    height, width, _ = images[0].pixels.shape
    entries = np.empty((height, width, 3))
    for rows in bands(height):
        along, across, turn = (image.pixels[rows, :, 0].astype(np.float64) for image in images)
        entries[rows] = entries_of_widths(
            np.maximum(along, LEAST_ALPHA), np.maximum(across, LEAST_ALPHA), np.pi * turn
        )
    matrices = mip_entries(entries) if mips else [entries]
    levels = [encode_level(each, encoding, format) for each in matrices]
    write_whole_bytes(out, write_map(levels, format))
    if json:
        record = {"encoding": encoding, "format": format, "files": [str(out)]}
        print_json(
            MapsEncodeOutput.model_validate(
                {**record, "levels": [_record(each) for each in levels]}
            )
        )
        return
    _print_levels(levels, encoding, format, out)


def _record(level: "EncodedLevel") -> dict:
    height, width, _ = level.texels.shape
    return {
        "width": width,
        "height": height,
        "bytes": len(level.data),
        "mean": level.mean,
        "percentile_99": level.percentile,
        "largest": level.largest,
    }


def _print_levels(levels: "list[EncodedLevel]", encoding: str, format: str, out: Path) -> None:
    from shadefit.terminal import print_table

    print_table(
        f"Total variation of decoded lobes, {encoding} in {format}",
        ["level", "bytes", "mean", "99 %", "largest"],
        [
            [
                f"{level.texels.shape[1]}×{level.texels.shape[0]}",
                f"{len(level.data)}",
                f"{level.mean:.4f}",
                f"{level.percentile:.4f}",
                f"{level.largest:.4f}",
            ]
            for level in levels
        ],
        f"{out}; the shader reads it by decode/aniso-{encoding}.",
    )
