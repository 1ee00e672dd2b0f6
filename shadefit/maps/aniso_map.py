"""Maps of anisotropic roughness as textures: mip levels, quantisation, compression, and errors.

A map has the matrix (Sxx, Sxy, Syy) of every texel. Its mip levels are averages of the matrices,
which is right for texels with the same normal. The error of a texel is the total variation between
the distribution of its matrix and that of the texel that a shader decodes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float, UInt8

from coefficients.textures.dds import write_coloured_dds
from programs import Program, evaluate, trace
from programs.functions import Parameter, function
from shadefit.images.block_compression import decode_blocks, encode_blocks
from shadefit.images.image import bands
from shading.maps.encode import encode, widths_of_entries
from shading.maps.encodings import decoding
from shading.maps.total_variation import total_variation

FORMATS = ("bc7", "bc1", "rgba8")
# Texels that are decoded at a time, so that memory is bounded
_CHUNK = 1 << 18

Entries = Float[np.ndarray, "height width 3"]


@dataclass(frozen=True)
class EncodedLevel:
    """One mip level: its bytes in the file, its texels as a GPU reads them, and its errors.

    `texels` (height, width, 3) are codes of 8 bits. `mean`, `percentile` (the 99th) and `largest`
    are total variations.
    """

    data: bytes
    texels: UInt8[np.ndarray, "height width 3"]
    mean: float
    percentile: float
    largest: float


def mip_entries(entries: Entries) -> list[np.ndarray]:
    """Return the matrices (h, w, …) of all mip levels, the first of which is the map itself.

    Raises ValueError for sides that are not powers of two.
    """
    for side in entries.shape[:2]:
        if side < 1 or side & (side - 1):
            height, width = entries.shape[:2]
            raise ValueError(
                f"a map of {width}×{height} texels has no mip levels: allowed are powers of two"
            )
    levels = [entries]
    while max(levels[-1].shape[:2]) > 1:
        last = levels[-1]
        for axis in (0, 1):
            if last.shape[axis] > 1:
                even, odd = (np.take(last, range(k, last.shape[axis], 2), axis) for k in (0, 1))
                last = (even + odd) / 2
        levels.append(last)
    return levels


def quantised(entries: Entries, encoding: str, largest: int = 255) -> Float[np.ndarray, "h w 3"]:
    """Return the codes 0 to `largest` of the matrices in an encoding, as floats."""
    alpha_t, alpha_b, theta = widths_of_entries(entries)
    channels = encode(encoding, np.minimum(alpha_t, 1.0), np.minimum(alpha_b, 1.0), theta)
    return np.rint(channels * largest)


def decoded(encoding: str, channels: Float[np.ndarray, "*texels 3"]) -> Float[np.ndarray, "*t 4"]:
    """Return (Sxx, Sxy, Syy, αtαb) of texels in [0, 1], in float64.

    Raises ValueError for an unknown encoding.
    """
    decoding(encoding)
    rows = np.asarray(channels, float).reshape(-1, 3)
    parts = [
        evaluate(_program(encoding), rows[first : first + _CHUNK])
        for first in range(0, len(rows), _CHUNK)
    ]
    return np.concatenate(parts).reshape(*channels.shape[:-1], 4)


def encode_level(entries: Entries, encoding: str, format: str) -> EncodedLevel:
    """Return one level in an encoding and a format, read back by an independent decoder.

    Raises ValueError for an unknown encoding or format.
    """
    if format not in FORMATS:
        raise ValueError(f"no format is called {format!r}: allowed are {', '.join(FORMATS)}")
    height, width, _ = entries.shape
    codes = np.empty(entries.shape, np.uint8)
    for rows in bands(height):
        codes[rows] = quantised(entries[rows], encoding)
    if format == "rgba8":
        opaque = np.full((height, width, 1), 255, np.uint8)
        data, read = np.concatenate([codes, opaque], axis=2).tobytes(), codes
    else:
        data = encode_blocks(format, codes)
        read = decode_blocks(format, data, width, height)
    error = np.empty((height, width))
    for rows in bands(height):
        seen = decoded(encoding, read[rows] / 255)[..., :3]
        error[rows] = total_variation(entries[rows], seen)
    return EncodedLevel(
        data, read, float(error.mean()), float(np.quantile(error, 0.99)), float(error.max())
    )


def write_map(levels: Sequence[EncodedLevel], format: str) -> bytes:
    """Return a DDS file of levels, the largest first."""
    height, width, _ = levels[0].texels.shape
    return write_coloured_dds([level.data for level in levels], width, height, format)


@cache
def _program(encoding: str) -> Program:
    parameters = [Parameter(each, (0.0, 1.0)) for each in "xyz"]
    return trace(function("entries", parameters, decoding(encoding).entries, result=4))
