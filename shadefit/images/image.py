"""An image with its colour space, and what may be required of one."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from shadefit.images.colour_space import require_colour_space

# The largest width and height in pixels, and the largest file. A small compressed file can declare
# a huge image, which would fill the memory.
MAX_EDGE = 8192
MAX_BYTES = 1 << 30
# Rows that are worked on at once, so that intermediate values of a large image need little memory
_ROWS = 256
_CHANNELS = {1: "grey", 2: "two channels", 3: "RGB", 4: "RGBA"}


@dataclass(frozen=True)
class Image:
    """Pixels (height, width, channels), and the colour space in which their values are.

    There are one to four channels. `name` is the file's path, for messages.
    """

    pixels: Float32[np.ndarray, "height width channels"]
    colour_space: str
    name: str


def image_of(pixels: np.ndarray, colour_space: str | None, name: str) -> Image:
    """Return the image of an array (height, width) or (height, width, channels) of finite numbers.

    Raises ValueError for another shape, for values that are not finite, for a size above
    `MAX_EDGE`, and if the colour space is not 'srgb' or 'linear'.
    """
    colour_space = require_colour_space(colour_space, name)
    array = np.asarray(pixels)
    if array.ndim == 2:
        array = array[..., None]
    if array.ndim != 3 or 0 in array.shape or array.shape[2] not in _CHANNELS:
        raise ValueError(f"{name}: shape {array.shape}: allowed is (height, width, 1 to 4)")
    require_size(array.shape[1], array.shape[0], name)
    with np.errstate(over="ignore"):
        array = np.ascontiguousarray(array, np.float32)
    if not all(np.isfinite(array[rows]).all() for rows in bands(len(array))):
        raise ValueError(f"{name}: some values are NaN or infinite: allowed are finite numbers")
    return Image(array, colour_space, name)


def bands(height: int) -> Iterator[slice]:
    """Return the rows of an image in parts, from the first to the last."""
    return (slice(top, min(top + _ROWS, height)) for top in range(0, height, _ROWS))


def require_size(width: int, height: int, name: str, max_edge: int = MAX_EDGE) -> None:
    """Raise ValueError if an image has no pixels or more than `max_edge` an edge."""
    if not (1 <= width <= max_edge and 1 <= height <= max_edge):
        raise ValueError(f"{name}: {width}×{height} pixels: allowed are {max_edge} an edge")


def require_channels(image: Image, *allowed: int) -> None:
    """Raise ValueError if an image has none of the `allowed` numbers of channels."""
    found = image.pixels.shape[2]
    if found not in allowed:
        names = ", ".join(f"{each} ({_CHANNELS[each]})" for each in allowed)
        raise ValueError(f"{image.name}: {found} channels ({_CHANNELS[found]}): allowed: {names}")


def require_power_of_two(image: Image) -> None:
    """Raise ValueError if an edge is no power of two, as whole mip chains need it."""
    height, width = image.pixels.shape[:2]
    if width & (width - 1) or height & (height - 1):
        raise ValueError(f"{image.name}: {width}×{height} pixels: a mip chain needs powers of two")


def require_same_size(first: Image, second: Image) -> None:
    """Raise ValueError if two images differ in width or height."""
    (height, width), (other_height, other_width) = (
        each.pixels.shape[:2] for each in (first, second)
    )
    if (height, width) != (other_height, other_width):
        raise ValueError(
            f"{second.name}: {other_width}×{other_height} pixels, but {first.name} has "
            f"{width}×{height}: both need the same size"
        )
