"""Images as files: linear colours to sRGB, and OpenEXR, uncompressed."""

import struct

import numpy as np

_MAGIC, _VERSION = 20000630, 2
_FLOAT = 2  # the pixel type of 32-bit floats


def srgb(linear: np.ndarray) -> np.ndarray:
    """Give sRGB in [0, 1] of linear colours: highlights roll off above 0.8, the rest is exact."""
    x = np.maximum(linear, 0)
    x = np.where(x > 0.8, 1 - 0.2 * np.exp(-(x - 0.8) / 0.2), x)
    return np.where(
        x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 0.0031308) ** (1 / 2.4) - 0.055
    )


def from_srgb(encoded: np.ndarray) -> np.ndarray:
    """Give linear colours of sRGB in [0, 1]."""
    low, high = encoded / 12.92, ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high)


def colour(text: str, name: str) -> tuple[float, float, float]:
    """Read '#rrggbb' as linear RGB. Raises ValueError, naming the option, for anything else."""
    digits = text.removeprefix("#")
    try:
        if len(digits) != 6:
            raise ValueError
        values = np.array([int(digits[i : i + 2], 16) for i in (0, 2, 4)]) / 255
    except ValueError:
        raise ValueError(f"{name} is {text!r}; allowed: a colour as #rrggbb") from None
    red, green, blue = (float(x) for x in from_srgb(values))
    return red, green, blue


def write_exr(channels: dict[str, np.ndarray]) -> bytes:
    """Give an OpenEXR file of named channels (height, width), stored as 32-bit floats.

    Scan lines without compression; a channel called 'layer.R' is the red of a layer.
    """
    names = sorted(channels)
    height, width = channels[names[0]].shape
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iB3xii", _FLOAT, 0, 1, 1) for name in names
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
    line = 8 + 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + line * y for y in range(height)))
    stacked = np.stack([channels[name] for name in names], axis=1).astype("<f4")
    rows = [struct.pack("<2i", y, line - 8) + stacked[y].tobytes() for y in range(height)]
    return header + offsets + b"".join(rows)
