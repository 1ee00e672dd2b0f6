"""Images from PNG, EXR and DDS files."""

import io
import os
from collections.abc import Callable, Generator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path

import numpy as np
from PIL.DdsImagePlugin import DdsImageFile
from PIL.ImageFile import ImageFile
from PIL.PngImagePlugin import PngImageFile

from coefficients.input_files import read_bounded
from shadefit.images.colour_space import SRGB, require_colour_space
from shadefit.images.image import MAX_BYTES, MAX_EDGE, Image, bands, image_of, require_size
from shadefit.images.optional_libraries import optional_library

# The most bytes of a pixel, four floats, and those of all other content of a file
_WIDEST, _OTHER_BYTES = 17, 1 << 24
FORMATS = (".png", ".exr", ".dds")
# Channels of an EXR file in the order of the image's channels
_LAYOUTS = (("R", "G", "B", "A"), ("R", "G", "B"), ("R", "G"), ("Y", "A"), ("R",), ("Y",))
_COLOURS = {"1": "L", "P": "RGB", "I;16": "I;16", "L": "L", "LA": "LA"}


def read_image(path: str | Path, colour_space: str | None, max_edge: int = MAX_EDGE) -> Image:
    """Return the image of a PNG, EXR or DDS file, with the values that the file holds.

    `colour_space` says how the values are meant: 'srgb' or 'linear'; nothing is converted. PNG
    files have 1 to 16 bits; palettes are resolved. DDS files have 8 bits or the blocks BC1 to BC5
    or BC7, of which the first mip level is read. EXR files hold linear values.

    Raises ValueError, in one line, if the colour space is not said, and for a file that is no such
    image, is broken, holds NaN or is larger than `max_edge` pixels an edge or `MAX_BYTES` bytes.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise ValueError(f"{path}: allowed are the files {', '.join(FORMATS)}")
    colour_space = require_colour_space(colour_space, str(path))
    if suffix == ".exr" and colour_space == SRGB:
        raise ValueError(f"{path}: EXR files hold linear values: allowed is linear")
    # Compression makes no file of pixels much larger than they are.
    data = read_bounded(path, min(MAX_BYTES, max_edge * max_edge * _WIDEST + _OTHER_BYTES))
    read = {".png": _read_png, ".exr": _read_exr, ".dds": _read_dds}[suffix]
    try:
        pixels = read(data, str(path), max_edge)
    except _RefusedError as error:
        raise ValueError(f"{path}: {error}") from None
    return image_of(pixels, colour_space, str(path))


class _RefusedError(Exception):
    """What is wrong with a file."""


def _opened(kind: type[ImageFile], data: bytes, name: str, max_edge: int) -> ImageFile:
    """Return a file of which only the header was read, and whose size is allowed."""
    try:
        file = kind(io.BytesIO(data))
    # A broken header raises many kinds of errors, such as struct.error and IndexError.
    except Exception:
        raise _RefusedError(f"it is no {kind.format} image that can be read") from None
    require_size(*file.size, name, max_edge)
    return file


def _decoded(file: ImageFile, mode: str) -> np.ndarray:
    """Return the values of a file, converted to a mode of Pillow."""
    try:
        file.load()
        return np.array(file if file.mode == mode else file.convert(mode))
    # Broken data raises many kinds of errors, too.
    except Exception as error:
        reason = str(error).partition("\n")[0] or type(error).__name__
        raise _RefusedError(f"its pixels cannot be decoded: {reason}") from None


def _read_png(data: bytes, name: str, max_edge: int) -> np.ndarray:
    file = _opened(PngImageFile, data, name, max_edge)
    if not file.tile:
        raise _RefusedError("it has no pixels")
    tile = file.tile[0]
    raw = tile.args if isinstance(tile.args, str) else ""
    if raw == "LA;16B":
        raise _RefusedError("16-bit grey with alpha is not read: store it as RGBA")
    if raw in ("RGB;16B", "RGBA;16B"):
        # Pillow keeps the high byte of each value. The mode for numbers whose low byte comes first
        # takes the other one, so that decoding twice gives all 16 bits.
        again = _opened(PngImageFile, data, name, max_edge)
        again.tile = [tile._replace(args=raw.replace("16B", "16L"))]
        high, low = _decoded(file, file.mode), _decoded(again, file.mode)
        return _scaled(
            high.shape, lambda rows: high[rows].astype(np.uint16) << 8 | low[rows], 65535
        )
    mode = _COLOURS.get(file.mode, file.mode)
    if file.mode == "P" and "transparency" in file.info:
        mode = "RGBA"
    scale = 65535 if mode == "I;16" else 255
    return _decoded(file, mode) / np.float32(scale)


def _scaled(
    shape: tuple[int, ...], codes: Callable[[slice], np.ndarray], largest: int
) -> np.ndarray:
    """Return codes, given by a function of rows, divided by the largest one, in float32."""
    pixels = np.empty(shape, np.float32)
    for rows in bands(shape[0]):
        pixels[rows] = codes(rows) / np.float32(largest)
    return pixels


def _read_dds(data: bytes, name: str, max_edge: int) -> np.ndarray:
    file = _opened(DdsImageFile, data, name, max_edge)
    block = getattr(file, "pixel_format", "")
    if block in ("BC5S", "BC6H", "BC6HS"):
        raise _RefusedError(f"{block} is not read: allowed are BC1 to BC5, BC7 and 8 bits")
    mode = "RGBA" if file.mode == "P" else file.mode
    pixels = _decoded(file, mode) / np.float32(255)
    return pixels[..., :2] if block == "BC5" else pixels


@contextmanager
def _silent_library() -> Generator[None]:
    """Lose what OpenEXR prints, and writes to standard error itself; it raises errors too."""
    try:
        kept = os.dup(2)
    except OSError:
        yield
        return
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        os.close(nowhere)
        with redirect_stdout(io.StringIO()):
            yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _read_exr(data: bytes, name: str, max_edge: int) -> np.ndarray:
    library = optional_library("OpenEXR")
    try:
        with _silent_library():
            header = library.File(io.BytesIO(data), header_only=True).header()
        (left, top), (right, bottom) = header["dataWindow"]
    # The library raises its own errors, and those of broken numbers.
    except Exception:
        raise _RefusedError("it is no EXR image that can be read") from None
    require_size(int(right) - int(left) + 1, int(bottom) - int(top) + 1, name, max_edge)
    try:
        with _silent_library():
            parts = library.File(io.BytesIO(data), separate_channels=True).parts
        channels = {key: each.pixels for key, each in parts[0].channels.items()}
    except Exception:
        raise _RefusedError("its pixels cannot be decoded") from None
    layout = next((each for each in _LAYOUTS if set(each) == set(channels)), None)
    if layout is None or len(parts) > 1:
        found = ", ".join(sorted(channels)[:8])
        raise _RefusedError(f"channels {found}: allowed are R, G, B, A; R, G, B; R, G; R; Y, A; Y")
    planes = [channels[each] for each in layout]
    if len({each.shape for each in planes}) > 1 or planes[0].ndim != 2:
        raise _RefusedError("its channels differ in size")
    return np.stack([each.astype(np.float32) for each in planes], axis=-1)
