"""DDS files with the DX10 header extension, as Microsoft's "Programming Guide for DDS" says."""

import struct

import numpy as np

# The numbers of DXGI_FORMAT: R32_FLOAT, R16_FLOAT, R16_UNORM and R8_UNORM.
_FORMATS = {"float32": 41, "float16": 54, "unorm16": 56, "unorm8": 61}
# DDSD_CAPS, _HEIGHT, _WIDTH, _PITCH and _PIXELFORMAT; and _DEPTH, for a volume.
_FLAGS, _FLAGS_DEPTH = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000, 0x800000
# DDSCAPS_TEXTURE; DDSCAPS_COMPLEX and DDSCAPS2_VOLUME, for a volume.
_CAPS, _CAPS_COMPLEX, _CAPS2_VOLUME = 0x1000, 0x8, 0x200000
_FOURCC = 0x4


def write_dds(texels: np.ndarray, texel: str) -> bytes:
    """Return a DDS file of texels (width,), (height, width) or (depth, height, width).

    `texel` is 'float32', 'float16', 'unorm16' or 'unorm8'; the array has the type of it.
    """
    dimensions = texels.ndim
    depth, height, width = (1,) * (3 - dimensions) + texels.shape
    volume = dimensions == 3
    header = struct.pack(
        "<7I44x",
        124,
        _FLAGS | (_FLAGS_DEPTH if volume else 0),
        height,
        width,
        width * texels.itemsize,
        depth if volume else 0,
        1,
    )
    header += struct.pack("<2I4s5I", 32, _FOURCC, b"DX10", 0, 0, 0, 0, 0)
    caps = _CAPS | (_CAPS_COMPLEX if volume else 0)
    header += struct.pack("<5I", caps, _CAPS2_VOLUME if volume else 0, 0, 0, 0)
    # D3D10_RESOURCE_DIMENSION_TEXTURE1D is 2, 2D is 3 and 3D is 4. The array has one texture.
    extension = struct.pack("<5I", _FORMATS[texel], 1 + dimensions, 0, 1, 0)
    return b"DDS " + header + extension + little_endian(texels)


def little_endian(texels: np.ndarray) -> bytes:
    """Return the bytes of an array, row by row, with the least significant byte of each first."""
    return texels.astype(texels.dtype.newbyteorder("<")).tobytes()
