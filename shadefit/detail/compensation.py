"""Sources that give a target with a detail, and how near the composed image comes to the target."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from shadefit.detail.closed_loop import batches, closed_loop
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
_ALL = slice(None)


@dataclass(frozen=True)
class ComposedErrors:
    """Errors of a composed image in codes of 8 bits: root mean square, PSNR in dB, and largest.

    `psnr` is None if there is no error.
    """

    rmse: float
    psnr: float | None
    largest: float


def errors_between(composed: np.ndarray, target: np.ndarray) -> ComposedErrors:
    """Return the errors of composed pixels, which are first rounded to 8 bits.

    `composed` and `target` are arrays of one shape, with values in [0, 1].
    """
    return _errors((composed[rows], target[rows].astype(float)) for rows in bands(len(composed)))


def _errors(parts: Iterable[tuple[np.ndarray, np.ndarray]]) -> ComposedErrors:
    """Return the errors of an image that comes in parts, composed pixels with those of a target."""
    squares, count, largest = 0.0, 0, 0.0
    for composed, target in parts:
        difference = np.floor(np.clip(composed, 0, 1) * 255.0 + 0.5) - 255.0 * target
        squares += float(np.sum(difference**2))
        count += difference.size
        largest = max(largest, float(np.abs(difference).max()))
    rmse = float(np.sqrt(squares / count))
    psnr = None if rmse == 0 else float(20 * np.log10(255 / rmse))
    return ComposedErrors(rmse, psnr, largest)


def _tile(detail: Image, like: Image) -> np.ndarray:
    """Return a detail's colours in float64, without alpha.

    Raises ValueError if the size of the other image is no multiple of the detail's, if the numbers
    of channels differ, and for values outside [0, 1].
    """
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


def _tiled_rows(tile: np.ndarray, like: Image, rows: slice) -> np.ndarray:
    """Return some rows of a tile that is repeated to the size of an image."""
    below = np.take(tile, range(rows.start, rows.stop), axis=0, mode="wrap")
    return np.tile(below, (1, like.pixels.shape[1] // tile.shape[1], 1))


def _colours(image: Image, rows: slice = _ALL) -> np.ndarray:
    require_channels(image, 1, 3, 4)
    return image.pixels[rows, :, :3].astype(float)


def composed_image(source: Image, detail: Image, operator: Operator) -> Image:
    """Return the source with the tiled detail put onto it, in the source's colour space."""
    onto = _tile(detail, source)
    pixels = np.empty((*source.pixels.shape[:2], onto.shape[2]), np.float32)
    for rows in bands(len(pixels)):
        blended = operator.blend(_within(source, rows), _tiled_rows(onto, source, rows))
        pixels[rows] = np.clip(blended, 0, 1)
    return image_of(pixels, source.colour_space, "the composed image")


def compensated_image(
    target: Image, detail: Image, operator: Operator, bits: int
) -> tuple[Image, ComposedErrors]:
    """Return the source that gives the target with the detail, rounded to `bits` (8 or 16).

    The errors are those of the rounded source.
    """
    onto, largest = _tile(detail, target), 2**bits - 1
    pixels = np.empty((*target.pixels.shape[:2], onto.shape[2]), np.float32)

    def parts() -> Iterator[tuple[np.ndarray, np.ndarray]]:
        for rows in bands(len(pixels)):
            wanted, under = _within(target, rows), _tiled_rows(onto, target, rows)
            stored = np.floor(operator.source(wanted, under) * largest + 0.5) / largest
            pixels[rows] = stored
            yield operator.blend(stored, under), wanted

    errors = _errors(parts())
    return image_of(pixels, target.colour_space, "the source"), errors


def compensated_dds(
    target: Image,
    detail: Image,
    operator: Operator,
    encoder: str = "closed-loop",
    advance: Callable[[], None] | None = None,
) -> tuple[bytes, ComposedErrors]:
    """Return the DDS file of a source in BC1 that gives the target with the detail.

    `encoder` is 'closed-loop', which minimises the error of the composed image, or 'quicktex',
    which minimises that of the source. `advance` is called after each part of at most 4096
    blocks. The errors are those of the blocks as texture2ddecoder decodes them.
    """
    if encoder not in ENCODERS:
        raise ValueError(f"encoder {encoder} is unknown: allowed are {', '.join(ENCODERS)}")
    onto = _tile(detail, target)
    require_blocks(image_of(target.pixels[..., :3], target.colour_space, target.name))
    height, width = target.pixels.shape[:2]
    encoded = []

    def parts() -> Iterator[tuple[np.ndarray, np.ndarray]]:
        for rows in bands(height):
            wanted, under = _within(target, rows), _tiled_rows(onto, target, rows)
            if encoder == "closed-loop":
                found = closed_loop(blocks_of(wanted), blocks_of(under), operator, advance)
                blocks = packed(*found)
            else:
                blocks = encode_bc1(operator.source(wanted, under))
            encoded.append(blocks)
            decoded = decode_bc1(blocks, len(wanted), width) / 255
            yield operator.blend(decoded, under), wanted

    errors = _errors(parts())
    return bc1_dds(b"".join(encoded), height, width), errors


def parts_of(height: int, width: int) -> int:
    """Return how often `compensated_dds` calls `advance` with the encoder 'closed-loop'."""
    blocks = ((rows.stop - rows.start) * width // 16 for rows in bands(height))
    return sum(len(list(batches(each))) for each in blocks)


def _within(image: Image, rows: slice = _ALL) -> np.ndarray:
    """Return the colours of an image in float64. Raises ValueError for values outside [0, 1]."""
    colours = _colours(image, rows)
    if colours.min() < 0 or colours.max() > 1:
        raise ValueError(f"{image.name}: values outside [0, 1] cannot be blended")
    return colours
