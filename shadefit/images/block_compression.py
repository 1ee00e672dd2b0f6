"""Block compression of textures: BC1, BC5 and BC7.

The encoders are those of quicktex (BC1, BC5) and etcpak (BC7). The decoder is another library,
texture2ddecoder, so that an error of an encoder cannot hide in its own decoder.
"""

import numpy as np
from jaxtyping import Shaped, UInt8

from shadefit.images.optional_libraries import optional_library

# The channels of a format, and the bytes of a block of 4×4 texels
CHANNELS: dict[str, int] = {"bc1": 3, "bc5": 2, "bc7": 3}
BLOCK_BYTES: dict[str, int] = {"bc1": 8, "bc5": 16, "bc7": 16}
# The levels of effort of quicktex's BC1 (0 to 18) and of etcpak's BC7 (0 to 4)
_BC1_LEVEL, _BC7_LEVEL = 18, 1
# texture2ddecoder and quicktex keep an image in 32-bit sizes.
_LARGEST_SIDE = 16384


def encode_blocks(format: str, texels: Shaped[np.ndarray, "height width channels"]) -> bytes:
    """Return the blocks of an image, row by row.

    `texels` has 3 channels for BC1 and BC7, and 2 for BC5. A side that is no multiple of 4 is
    continued by its last texels. All channels have the same weight. Raises ValueError for an
    unknown format, other channels, another type, and a side that is empty or above 16384.
    """
    _require(format)
    if texels.dtype != np.uint8:
        raise ValueError(f"texels of type {texels.dtype}: allowed is uint8")
    if texels.ndim != 3 or texels.shape[2] != CHANNELS[format]:
        raise ValueError(
            f"texels of shape {texels.shape}: allowed for {format} is (height, width, "
            f"{CHANNELS[format]})"
        )
    height, width, channels = texels.shape
    _require_sides(width, height)
    whole = np.full((-(-height // 4) * 4, -(-width // 4) * 4, 4), 255, np.uint8)
    whole[..., channels:3] = 0
    padding = [(0, whole.shape[k] - texels.shape[k]) for k in range(2)]
    whole[..., :channels] = np.pad(texels, [*padding, (0, 0)], mode="edge")
    return _bc7(whole) if format == "bc7" else _quicktex(format, whole)


def decode_blocks(
    format: str, blocks: bytes, width: int, height: int
) -> UInt8[np.ndarray, "height width channels"]:
    """Return the texels of blocks: 3 channels for BC1 and BC7, 2 for BC5.

    Raises ValueError for an unknown format, and if the number of bytes is not that of the size.
    """
    _require(format)
    _require_sides(width, height)
    expected = size_in_bytes(format, width, height)
    if len(blocks) != expected:
        raise ValueError(
            f"{len(blocks)} bytes of {format} for {width}×{height}: allowed are {expected}"
        )
    decode = getattr(optional_library("texture2ddecoder"), f"decode_{format}")
    # Some decoders cut off what is outside the image, and some write it: here nothing is outside.
    rows, columns = -(-height // 4) * 4, -(-width // 4) * 4
    bgra = np.frombuffer(decode(blocks, columns, rows), np.uint8).reshape(rows, columns, 4)
    return np.ascontiguousarray(bgra[:height, :width, 2::-1][..., : CHANNELS[format]])


def size_in_bytes(format: str, width: int, height: int) -> int:
    """Return the number of bytes of the blocks of an image."""
    return -(-width // 4) * -(-height // 4) * BLOCK_BYTES[format]


def _bc7(rgba: np.ndarray) -> bytes:
    etcpak = optional_library("etcpak")
    parameters = etcpak.BC7CompressBlockParams()
    # The default weights are those of perceived colour, which the channels of a map are not.
    parameters.init_linear_weights()
    parameters.m_uber_level = _BC7_LEVEL
    height, width, _ = rgba.shape
    return etcpak.compress_bc7(rgba.tobytes(), width, height, parameters)


def _quicktex(format: str, rgba: np.ndarray) -> bytes:
    height, width, _ = rgba.shape
    module = optional_library(f"quicktex.s3tc.{format}")
    image = optional_library("quicktex").RawTexture.frombytes(rgba.tobytes(), width, height)
    encoder = module.BC1Encoder(_BC1_LEVEL) if format == "bc1" else module.BC5Encoder(0, 1)
    return encoder.encode(image).tobytes()


def _require(format: str) -> None:
    if format not in CHANNELS:
        raise ValueError(f"no block format is called {format!r}: allowed are {', '.join(CHANNELS)}")


def _require_sides(width: int, height: int) -> None:
    for name, side in (("width", width), ("height", height)):
        if not 1 <= side <= _LARGEST_SIDE:
            raise ValueError(f"{name} {side}: allowed are whole numbers from 1 to {_LARGEST_SIDE}")
