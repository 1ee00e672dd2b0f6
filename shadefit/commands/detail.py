"""`shadefit detail`: compensate a source for a detail map, and compose the two."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json

if TYPE_CHECKING:
    from shadefit.detail import ComposedErrors
    from shadefit.material_outputs import DetailOutput

detail = typer.Typer(help="Detail maps: compensate sources for them, and compose both.")

_Operator = Annotated[
    str, typer.Option(help="overlay, smooth-overlay or symmetric-overlay: how both are combined.")
]
_Space = Annotated[
    str | None,
    typer.Option(
        help="srgb or linear: how the values of all files are meant. They are combined as they are."
    ),
]
_Detail = Annotated[
    Path, typer.Argument(help="The detail as it is decoded: PNG, EXR or DDS. It is tiled.")
]


@detail.command(
    "compensate",
    epilog="Example: shadefit detail compensate target.png detail.png --colour-space srgb "
    "-o source.dds",
)
def compensate(
    target: Annotated[Path, typer.Argument(help="The wanted image: PNG, EXR or DDS.")],
    detail: _Detail,
    out: Annotated[
        Path, typer.Option("-o", "--out", help="File for the source: .dds is BC1, or .png.")
    ],
    operator: _Operator = "smooth-overlay",
    colour_space: _Space = None,
    encoder: Annotated[
        str,
        typer.Option(
            help="For .dds: closed-loop minimises the error of the composed image, quicktex that "
            "of the source."
        ),
    ] = "closed-loop",
    bits: Annotated[int, typer.Option(help="For .png: 8 or 16 bits a value.")] = 8,
    json: Json = False,
) -> None:
    """Write the source that gives the target when the detail is put onto it.

    Errors are those of the composed image, of the source as it is stored.
    """
    from coefficients.files import require_writable_file, write_whole_bytes
    from shadefit.detail import compensated_dds, compensated_image
    from shadefit.detail import operator as operator_of
    from shadefit.detail.compensation import parts_of
    from shadefit.images import read_image, write_image
    from shadefit.material_outputs import DetailOutput
    from shadefit.progress import stages

    suffix = out.suffix.lower()
    if suffix not in (".dds", ".png"):
        raise ValueError(f"--out {out}: allowed are the files .dds, .png")
    if bits not in (8, 16):
        raise ValueError(f"--bits {bits}: allowed are 8, 16")
    require_writable_file(out)
    chosen = operator_of(operator)
    images = (read_image(target, colour_space), read_image(detail, colour_space))
    if suffix == ".dds":
        count = parts_of(*images[0].pixels.shape[:2])
        with stages() as progress:
            stage = progress.begin("BC1 blocks", total=count)
            data, errors = compensated_dds(*images, chosen, encoder, stage.advance)
        write_whole_bytes(out, data)
    else:
        source, errors = compensated_image(*images, chosen, bits)
        write_image(out, source, bits)
    _show(
        DetailOutput(
            operator=operator,
            colour_space=images[0].colour_space,
            encoder=encoder if suffix == ".dds" else None,
            rmse=errors.rmse,
            psnr=errors.psnr,
            largest=errors.largest,
            files=[str(out)],
        ),
        json,
    )


@detail.command(
    "compose",
    epilog="Example: shadefit detail compose source.dds detail.png --colour-space srgb "
    "-o composed.png --target target.png",
)
def compose(
    source: Annotated[Path, typer.Argument(help="The source: PNG, EXR or DDS.")],
    detail: _Detail,
    out: Annotated[Path, typer.Option("-o", "--out", help="File for the image: .png or .exr.")],
    operator: _Operator = "smooth-overlay",
    colour_space: _Space = None,
    target: Annotated[
        Path | None, typer.Option(help="An image of the same size to measure the errors from.")
    ] = None,
    bits: Annotated[int, typer.Option(help="For .png: 8 or 16 bits a value.")] = 8,
    json: Json = False,
) -> None:
    """Write the image of a source with a detail put onto it, as a shader computes it."""
    from coefficients.files import require_writable_file
    from shadefit.detail import composed_image, errors_between
    from shadefit.detail import operator as operator_of
    from shadefit.images import read_image, require_same_size, write_image
    from shadefit.material_outputs import DetailOutput

    if out.suffix.lower() not in (".png", ".exr"):
        raise ValueError(f"--out {out}: allowed are the files .png, .exr")
    require_writable_file(out)
    chosen = operator_of(operator)
    composed = composed_image(
        read_image(source, colour_space), read_image(detail, colour_space), chosen
    )
    errors: ComposedErrors | None = None
    if target is not None:
        wanted = read_image(target, colour_space)
        require_same_size(composed, wanted)
        colours = composed.pixels.shape[2]
        if wanted.pixels.shape[2] < colours:
            raise ValueError(f"{target}: it has fewer channels than the composed image")
        errors = errors_between(composed.pixels, wanted.pixels[..., :colours])
    write_image(out, composed, bits)
    _show(
        DetailOutput(
            operator=operator,
            colour_space=composed.colour_space,
            encoder=None,
            rmse=None if errors is None else errors.rmse,
            psnr=None if errors is None else errors.psnr,
            largest=None if errors is None else errors.largest,
            files=[str(out)],
        ),
        json,
    )


def _show(output: "DetailOutput", json: bool) -> None:
    from shadefit.terminal import print_json, print_lines

    if json:
        print_json(output)
        return
    if output.rmse is not None:
        psnr = "" if output.psnr is None else f", PSNR {output.psnr:.2f} dB"
        print(
            f"composed image: RMSE {output.rmse:.3f} codes of 8 bits{psnr}, "
            f"largest {output.largest:.0f}"
        )
    for each in output.files:
        print_lines(each)
