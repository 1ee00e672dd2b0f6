"""Images to PNG and EXR files."""

import struct
import zlib
from pathlib import Path

import numpy as np

from coefficients.files import write_whole_bytes
from coefficients.textures.exr import write_exr
from shadefit.images.colour_space import SRGB
from shadefit.images.image import Image, bands

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# The colour types of PNG, by the number of channels
_COLOUR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}
_NAMES = {1: "Y", 2: "YA", 3: "RGB", 4: "RGBA"}


def write_image(path: str | Path, image: Image, bits: int = 8) -> None:
    """Write an image as PNG with 8 or 16 bits, or as EXR with 32-bit floats, by the file's name.

    An sRGB image gets PNG's sRGB chunk. EXR files hold linear values. The file is written
    completely or not at all.

    Raises ValueError for another kind of file, for values outside [0, 1] in a PNG file, and for an
    sRGB image in an EXR file.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".png":
        write_whole_bytes(path, png_bytes(image, bits))
    elif suffix == ".exr":
        if image.colour_space == SRGB:
            raise ValueError(f"{path}: EXR files hold linear values, and the image is in sRGB")
        names = _NAMES[image.pixels.shape[2]]
        channels = {name: image.pixels[..., k] for k, name in enumerate(names)}
        write_whole_bytes(path, write_exr(channels))
    else:
        raise ValueError(f"{path}: allowed are the files .png, .exr")


def png_bytes(image: Image, bits: int = 8) -> bytes:
    """Return the PNG file of an image in [0, 1], with 8 or 16 bits a value.

    Pillow writes no colours of 16 bits, so the chunks are put together here, with the row filter
    "up". The same image gives the same bytes.
    """
    if bits not in (8, 16):
        raise ValueError(f"{bits} bits: allowed are 8, 16")
    if image.pixels.min() < 0 or image.pixels.max() > 1:
        raise ValueError(f"{image.name}: values outside [0, 1] do not fit into a PNG file")
    height, width, channels = image.pixels.shape
    largest, kind = (255, "u1") if bits == 8 else (65535, ">u2")
    codes = np.empty(image.pixels.shape, kind)
    for part in bands(height):
        codes[part] = np.floor(image.pixels[part] * np.float64(largest) + 0.5)
    rows = codes.reshape(height, -1).view(np.uint8)
    filtered = np.full((height, 1 + rows.shape[1]), 2, np.uint8)
    filtered[:, 1:] = rows
    filtered[1:, 1:] -= rows[:-1]
    header = struct.pack(">2I5B", width, height, bits, _COLOUR_TYPES[channels], 0, 0, 0)
    colour = _chunk(b"sRGB", b"\0") if image.colour_space == SRGB else b""
    data = _chunk(b"IDAT", zlib.compress(filtered.data, 6))
    return _SIGNATURE + _chunk(b"IHDR", header) + colour + data + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    checksum = zlib.crc32(kind + data)
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checksum)
