"""Sources that give a target with a detail, and how near the composed image comes to the target."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from shadefit.detail.closed_loop import closed_loop
from shadefit.detail.operators import Operator
from shadefit.images.bc1 import (
    bc1_dds,
    blocks_of,
    decode_bc1,
    encode_bc1,
    packed,
    require_blocks,
)
from shadefit.images.image import Image, bands, image_of, require_channels

ENCODERS = ("closed-loop", "quicktex")


@dataclass(frozen=True)
class ComposedErrors:
    """Errors of a composed image in codes of 8 bits: root mean square, PSNR in dB, and largest.

    `psnr` is None if there is no error.
    """

    rmse: float
    psnr: float | None
    largest: float


def errors_between(composed: np.ndarray, target: np.ndarray) -> ComposedErrors:
    """Return the errors of composed pixels in [0, 1], which are first rounded to 8 bits."""
    difference = np.floor(np.clip(composed, 0, 1) * 255.0 + 0.5) - 255.0 * target
    rmse = float(np.sqrt(np.mean(difference**2)))
    psnr = None if rmse == 0 else float(20 * np.log10(255 / rmse))
    return ComposedErrors(rmse, psnr, float(np.abs(difference).max()))


def tiled(detail: Image, like: Image) -> np.ndarray:
    """Return a detail's pixels in float64, repeated to the size of another image.

    An alpha channel is left out. Raises ValueError if the size is no multiple of the detail's, or
    the numbers of channels differ.
    """
    tile = _tile(detail, like)
    (height, width), (tall, wide) = tile.shape[:2], like.pixels.shape[:2]
    return np.tile(tile, (tall // height, wide // width, 1))


def _tile(detail: Image, like: Image) -> np.ndarray:
    """Return a detail's pixels in float64. Raises ValueError as `tiled` does."""
    colours = _colours(detail)
    (height, width), (tall, wide) = colours.shape[:2], like.pixels.shape[:2]
    if tall % height or wide % width:
        raise ValueError(
            f"{detail.name}: {width}×{height} pixels: {like.name} has {wide}×{tall}, which is no "
            "multiple of it"
        )
    require_channels(like, 1, 3, 4)
    if colours.shape[2] != min(like.pixels.shape[2], 3):
        raise ValueError(f"{detail.name} and {like.name} need the same number of colours")
    if colours.min() < 0 or colours.max() > 1:
        raise ValueError(f"{detail.name}: values outside [0, 1] cannot be blended")
    return colours


def _colours(image: Image) -> np.ndarray:
    require_channels(image, 1, 3, 4)
    pixels = image.pixels.astype(float)
    return pixels[..., :3] if pixels.shape[2] == 4 else pixels


def composed_image(source: Image, detail: Image, operator: Operator) -> Image:
    """Return the source with the tiled detail put onto it, in the source's colour space."""
    onto = _tile(detail, source)
    pixels = np.empty((*source.pixels.shape[:2], onto.shape[2]), np.float32)
    for rows in bands(len(pixels)):
        part = _within(replace(source, pixels=source.pixels[rows]))
        below = np.take(onto, range(rows.start, rows.stop), axis=0, mode="wrap")
        beside = np.tile(below, (1, part.shape[1] // onto.shape[1], 1))
        pixels[rows] = np.clip(operator.blend(part, beside), 0, 1)
    return image_of(pixels, source.colour_space, "the composed image")


def compensated_image(
    target: Image, detail: Image, operator: Operator, bits: int
) -> tuple[Image, ComposedErrors]:
    """Return the source that gives the target with the detail, rounded to `bits` (8 or 16).

    The errors are those of the rounded source.
    """
    wanted, onto = _within(target), tiled(detail, target)
    largest = 2**bits - 1
    codes = np.floor(operator.source(wanted, onto) * largest + 0.5)
    source = image_of(codes / largest, target.colour_space, "the source")
    return source, errors_between(operator.blend(codes / largest, onto), wanted)


def compensated_dds(
    target: Image,
    detail: Image,
    operator: Operator,
    encoder: str = "closed-loop",
    advance: Callable[[], None] | None = None,
) -> tuple[bytes, ComposedErrors]:
    """Return the DDS file of a source in BC1 that gives the target with the detail.

    `encoder` is 'closed-loop', which minimises the error of the composed image, or 'quicktex',
    which minimises that of the source. `advance` is called after each part of 4096 blocks. The
    errors are those of the blocks as texture2ddecoder decodes them.
    """
    if encoder not in ENCODERS:
        raise ValueError(f"encoder {encoder} is unknown: allowed are {', '.join(ENCODERS)}")
    wanted, onto = _within(target), tiled(detail, target)
    require_blocks(image_of(wanted, target.colour_space, target.name))
    height, width = wanted.shape[:2]
    if encoder == "closed-loop":
        parts = closed_loop(blocks_of(wanted), blocks_of(onto), operator, advance)
        blocks = packed(*parts)
    else:
        blocks = encode_bc1(operator.source(wanted, onto))
    decoded = decode_bc1(blocks, height, width) / 255
    errors = errors_between(operator.blend(decoded, onto), wanted)
    return bc1_dds(blocks, height, width), errors


def _within(image: Image) -> np.ndarray:
    """Return the colours of an image in float64. Raises ValueError for values outside [0, 1]."""
    colours = _colours(image)
    if colours.min() < 0 or colours.max() > 1:
        raise ValueError(f"{image.name}: values outside [0, 1] cannot be blended")
    return colours
