"""KTX2 files, as the Khronos "KTX File Format Specification" version 2.0 says."""

import struct

import numpy as np

from coefficients.textures.dds import little_endian

_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
# The numbers of VkFormat: R32_SFLOAT, R16_SFLOAT, R16_UNORM and R8_UNORM.
_FORMATS = {"float32": 100, "float16": 76, "unorm16": 70, "unorm8": 9}
# In a data format descriptor: a sample is a float, and may be negative.
_FLOAT, _SIGNED = 0x80, 0x40
# The colour model RGBSDA, the primaries of BT.709, and the transfer function 'linear'.
_MODEL, _PRIMARIES, _TRANSFER = 1, 1, 1
_HEADER, _LEVEL = 80, 24


def write_ktx2(texels: np.ndarray, texel: str, writer: str = "shadefit") -> bytes:
    """Return a KTX2 file of texels (width,), (height, width) or (depth, height, width).

    `texel` is 'float32', 'float16', 'unorm16' or 'unorm8'; the array has the type of it. There is
    one level, without compression. `writer` is the value of the key KTXwriter.
    """
    # A height or depth of 0 says that the texture has no such dimension.
    depth, height, width = (0,) * (3 - texels.ndim) + texels.shape
    described = _descriptor(texel, texels.itemsize)
    keys = _entry("KTXorientation", "rdi"[: texels.ndim]) + _entry("KTXwriter", writer)
    at_descriptor = _HEADER + _LEVEL
    at_keys = at_descriptor + len(described)
    # The level begins at a multiple of 4 and of the size of a texel.
    data = little_endian(texels)
    before = at_keys + len(keys)
    begin = -(-before // 4) * 4
    header = struct.pack(
        "<9I", _FORMATS[texel], texels.itemsize, width, height, depth, 0, 1, 1, 0
    ) + struct.pack("<4I2Q", at_descriptor, len(described), at_keys, len(keys), 0, 0)
    level = struct.pack("<3Q", begin, len(data), len(data))
    padding = b"\0" * (begin - before)
    return _IDENTIFIER + header + level + described + keys + padding + data


def _descriptor(texel: str, size: int) -> bytes:
    """Return the data format descriptor of texels with one channel of `size` bytes."""
    kind, lower, upper = 0, 0, (1 << 8 * size) - 1
    if texel.startswith("float"):
        # The bits of −1 and of 1 as 32-bit floats.
        kind, lower, upper = _FLOAT | _SIGNED, 0xBF800000, 0x3F800000
    sample = struct.pack("<HBB3I", 0, 8 * size - 1, kind, 0, lower, upper)
    block = struct.pack("<I2H", 0, 2, 24 + len(sample))
    block += struct.pack("<4B4B8B", _MODEL, _PRIMARIES, _TRANSFER, 0, *(0,) * 4, size, *(0,) * 7)
    return struct.pack("<I", 4 + len(block) + len(sample)) + block + sample


def _entry(key: str, value: str) -> bytes:
    text = key.encode() + b"\0" + value.encode() + b"\0"
    return struct.pack("<I", len(text)) + text + b"\0" * (-len(text) % 4)
