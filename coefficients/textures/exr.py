"""OpenEXR files without compression, as OpenEXR's "File Layout" document describes them."""

import io
import struct

import numpy as np

_MAGIC, _VERSION = 20000630, 2
# The numbers of the pixel types: half floats and 32-bit floats.
_PIXELS = {"<f2": 1, "<f4": 2}


def write_exr(channels: dict[str, np.ndarray], pixel: str = "<f4") -> bytes:
    """Return an OpenEXR file of named channels (height, width), stored as `pixel`.

    `pixel` is '<f4' for 32-bit floats and '<f2' for half floats. A channel with the name 'layer.R'
    is the red channel of a layer.
    """
    names, size = sorted(channels), np.dtype(pixel).itemsize
    height, width = channels[names[0]].shape
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iB3xii", _PIXELS[pixel], 0, 1, 1) for name in names
    )
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = (
        ("channels", "chlist", listed + b"\0"),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    )
    header = struct.pack("<2i", _MAGIC, _VERSION)
    for key, kind, value in attributes:
        header += key.encode() + b"\0" + kind.encode() + b"\0"
        header += struct.pack("<i", len(value)) + value
    header += b"\0"
    line = 8 + size * width * len(names)
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + line * y for y in range(height)))
    # Each line of the image has its number, its size, and then a row of each channel.
    file = io.BytesIO()
    file.write(header + offsets)
    for y in range(height):
        file.write(struct.pack("<2i", y, line - 8))
        file.write(np.stack([channels[name][y].astype(pixel) for name in names]).tobytes())
    return file.getvalue()
