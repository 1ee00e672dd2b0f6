"""DDS files with the DX10 header extension, as Microsoft's "Programming Guide for DDS" says."""

import struct
from collections.abc import Sequence

import numpy as np

# The numbers of DXGI_FORMAT: R32_FLOAT, R16_FLOAT, R16_UNORM and R8_UNORM.
_FORMATS = {"float32": 41, "float16": 54, "unorm16": 56, "unorm8": 61}
# BC1_UNORM, BC5_UNORM, BC7_UNORM and R8G8B8A8_UNORM, and the bytes of a block of 4×4 texels or of a
# texel
_COLOURS = {"bc1": (71, 8), "bc5": (83, 16), "bc7": (98, 16), "rgba8": (28, 4)}
# DDSD_CAPS, _HEIGHT, _WIDTH, _PITCH and _PIXELFORMAT; and _DEPTH, for a volume.
_FLAGS, _FLAGS_DEPTH = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000, 0x800000
# DDSCAPS_TEXTURE; DDSCAPS_COMPLEX and DDSCAPS2_VOLUME, for a volume.
_CAPS, _CAPS_COMPLEX, _CAPS2_VOLUME = 0x1000, 0x8, 0x200000
_FOURCC = 0x4
# DDSD_LINEARSIZE in place of _PITCH; DDSD_MIPMAPCOUNT, and DDSCAPS_MIPMAP.
_FLAGS_BLOCKS, _FLAGS_MIPS, _CAPS_MIPS = 0x1 | 0x2 | 0x4 | 0x80000 | 0x1000, 0x20000, 0x400000


def write_dds(texels: np.ndarray, texel: str) -> bytes:
    """Return a DDS file of texels (width,), (height, width) or (depth, height, width).

    `texel` is 'float32', 'float16', 'unorm16' or 'unorm8'; the array has the type of it.
    """
    dimensions = texels.ndim
    depth, height, width = (1,) * (3 - dimensions) + texels.shape
    volume = dimensions == 3
    flags = _FLAGS | (_FLAGS_DEPTH if volume else 0)
    size = (height, width, width * texels.itemsize, depth if volume else 0, 1)
    caps = _CAPS | (_CAPS_COMPLEX if volume else 0), _CAPS2_VOLUME if volume else 0
    return _header(flags, size, caps, _FORMATS[texel], dimensions) + little_endian(texels)


def write_coloured_dds(levels: Sequence[bytes], width: int, height: int, format: str) -> bytes:
    """Return a DDS file of a texture of several channels, with mip levels.

    `levels` has the blocks or texels of each level, the largest first; each side is half of that of
    the level before, rounded down, and at least 1. `format` is 'bc1', 'bc5', 'bc7' or 'rgba8'. No
    format is one of sRGB. Raises ValueError if a level has another number of bytes than its size.
    """
    number, unit = _COLOURS[format]
    blocks = format != "rgba8"
    for k, level in enumerate(levels):
        sides = (max(width >> k, 1), max(height >> k, 1))
        across, down = (-(-side // 4) for side in sides) if blocks else sides
        if len(level) != across * down * unit:
            raise ValueError(
                f"level {k} has {len(level)} bytes: allowed are {across * down * unit} for "
                f"{sides[0]}×{sides[1]} in {format}"
            )
    several = len(levels) > 1
    flags = (_FLAGS_BLOCKS if blocks else _FLAGS) | (_FLAGS_MIPS if several else 0)
    size = (height, width, len(levels[0]) if blocks else 4 * width, 0, len(levels))
    caps = _CAPS | (_CAPS_COMPLEX | _CAPS_MIPS if several else 0), 0
    return _header(flags, size, caps, number, 2) + b"".join(levels)


def _header(
    flags: int, size: tuple[int, ...], caps: tuple[int, int], number: int, dimensions: int
) -> bytes:
    """Return the headers; `size` is height, width, pitch or size, depth and number of levels."""
    header = struct.pack("<7I44x", 124, flags, *size)
    header += struct.pack("<2I4s5I", 32, _FOURCC, b"DX10", 0, 0, 0, 0, 0)
    header += struct.pack("<5I", *caps, 0, 0, 0)
    # D3D10_RESOURCE_DIMENSION_TEXTURE1D is 2, 2D is 3 and 3D is 4. The array has one texture.
    return b"DDS " + header + struct.pack("<5I", number, 1 + dimensions, 0, 1, 0)


def little_endian(texels: np.ndarray) -> bytes:
    """Return the bytes of an array, row by row, with the least significant byte of each first."""
    return texels.astype(texels.dtype.newbyteorder("<")).tobytes()
