"""Blocks of BC1: 4×4 texels of two endpoints with 5, 6 and 5 bits, and an index of each texel.

Blocks here are in the mode of four colours, in which the first endpoint's code is above the second.
Otherwise a block means three colours and black. Colours are codes 0 to 255.
"""

import struct

import numpy as np
from jaxtyping import Float, Integer, UInt8

from shadefit.images.image import Image, require_channels
from shadefit.images.optional_libraries import optional_library

EDGE = 4
# The largest code of each channel of an endpoint
LARGEST = np.array([31, 63, 31])
# Where a place between the endpoints, from 0 at the first to 3 at the second, is stored
_INDEX_OF_PLACE = np.array([0, 2, 3, 1], np.uint32)


def require_blocks(image: Image) -> None:
    """Raise ValueError if an image is no RGB image whose edges are multiples of four."""
    require_channels(image, 3)
    height, width = image.pixels.shape[:2]
    if height % EDGE or width % EDGE:
        raise ValueError(f"{image.name}: {width}×{height} pixels: BC1 needs multiples of 4")


def blocks_of(pixels: np.ndarray) -> np.ndarray:
    """Return the blocks (n, 16, channels) of pixels (height, width, channels), row by row."""
    height, width, channels = pixels.shape
    split = pixels.reshape(height // EDGE, EDGE, width // EDGE, EDGE, channels)
    return split.transpose(0, 2, 1, 3, 4).reshape(-1, EDGE * EDGE, channels)


def pixels_of(blocks: np.ndarray, height: int, width: int) -> np.ndarray:
    """Return the pixels (height, width, channels) of blocks (n, 16, channels)."""
    split = blocks.reshape(height // EDGE, width // EDGE, EDGE, EDGE, -1)
    return split.transpose(0, 2, 1, 3, 4).reshape(height, width, -1)


def expanded(endpoints: Integer[np.ndarray, "*n 3"]) -> Integer[np.ndarray, "*n 3"]:
    """Return the colours 0 to 255 of endpoints with 5, 6 and 5 bits: their bits repeat."""
    left, right = np.array([3, 2, 3]), np.array([2, 4, 2])
    return (endpoints << left) | (endpoints >> right)


def palette(endpoints: Integer[np.ndarray, "*n 2 3"]) -> Integer[np.ndarray, "*n 4 3"]:
    """Return the four colours from the first endpoint to the second, as decoders compute them."""
    colours = expanded(endpoints)
    first, second = colours[..., 0, :], colours[..., 1, :]
    between = ((2 * first + second) // 3, (first + 2 * second) // 3)
    return np.stack([first, *between, second], axis=-2)


def packed(endpoints: Integer[np.ndarray, "n 2 3"], places: Integer[np.ndarray, "n 16"]) -> bytes:
    """Return the bytes of blocks, 8 each, in the mode of four colours.

    `places` are 0 at the first endpoint to 3 at the second. Endpoints are swapped where the first
    is below the second. Where they are equal, all four colours are, too, and the index is 0.
    """
    red, green, blue = np.moveaxis(endpoints.astype(np.uint32), -1, 0)
    codes = (red << 11) | (green << 5) | blue
    first, second = codes.T
    swapped = (first < second)[:, None]
    indices = _INDEX_OF_PLACE[np.where(swapped, 3 - places, places)]
    indices = np.where((first == second)[:, None], 0, indices)
    bits = np.bitwise_or.reduce(indices << (2 * np.arange(16, dtype=np.uint32)), axis=1)
    ends = np.sort(codes, axis=1)[:, ::-1].astype("<u2").view("<u4")
    return np.concatenate([ends, bits.astype("<u4")[:, None]], axis=1).tobytes()


def endpoints_of(data: bytes) -> Integer[np.ndarray, "n 2 3"]:
    """Return the endpoints of blocks, with 5, 6 and 5 bits."""
    codes = np.frombuffer(data, "<u2").reshape(-1, 4)[:, :2].astype(int)
    return np.stack([codes >> 11, codes >> 5 & 63, codes & 31], axis=-1)


def decode_bc1(data: bytes, height: int, width: int) -> UInt8[np.ndarray, "height width 3"]:
    """Return the colours of BC1 blocks, by the library texture2ddecoder."""
    decoded = optional_library("texture2ddecoder").decode_bc1(data, width, height)
    # The library's order is blue, green, red, alpha.
    return np.frombuffer(decoded, np.uint8).reshape(height, width, 4)[..., 2::-1]


def encode_bc1(pixels: Float[np.ndarray, "height width 3"], level: int = 18) -> bytes:
    """Return BC1 blocks of pixels in [0, 1], by the library quicktex. `level` is 0 to 18."""
    quicktex = optional_library("quicktex.s3tc.bc1")
    height, width, _ = pixels.shape
    rgba = np.full((height, width, 4), 255, np.uint8)
    rgba[..., :3] = np.floor(np.clip(pixels, 0, 1) * 255 + 0.5)
    raw = optional_library("quicktex").RawTexture.frombytes(rgba.tobytes(), width, height)
    return quicktex.BC1Encoder(level).encode(raw).tobytes()


def bc1_dds(blocks: bytes, height: int, width: int) -> bytes:
    """Return a DDS file of BC1 blocks without mip levels, as Microsoft's guide to DDS says.

    The header is the old one with the code DXT1, which all readers know. It holds no colour space.
    """
    # DDSD_CAPS, _HEIGHT, _WIDTH, _PIXELFORMAT and _LINEARSIZE; DDPF_FOURCC; DDSCAPS_TEXTURE
    flags = 0x1 | 0x2 | 0x4 | 0x1000 | 0x80000
    header = struct.pack("<7I44x", 124, flags, height, width, len(blocks), 0, 0)
    header += struct.pack("<2I4s5I", 32, 0x4, b"DXT1", 0, 0, 0, 0, 0)
    return b"DDS " + header + struct.pack("<5I", 0x1000, 0, 0, 0, 0) + blocks
