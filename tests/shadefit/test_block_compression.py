"""Block compression: sizes, channels, an independent decoder, and what is refused."""

import numpy as np
import pytest

from shadefit.images.block_compression import CHANNELS, decode_blocks, encode_blocks


def gradient(height: int, width: int, channels: int) -> np.ndarray:
    y, x = np.mgrid[0:height, 0:width]
    return np.stack([3 * x, 2 * y, x + y], axis=-1)[..., :channels].astype(np.uint8)


# Largest differences in codes on a smooth gradient, measured as 5, 0 and 4
@pytest.mark.parametrize(("format", "allowed"), [("bc1", 6), ("bc5", 2), ("bc7", 4)])
@pytest.mark.parametrize(("height", "width"), [(32, 32), (1, 1), (5, 7), (4, 16)])
def test_texels_come_back_in_their_channels(format, allowed, height, width):
    texels = gradient(height, width, CHANNELS[format])
    blocks = encode_blocks(format, texels)
    assert len(blocks) == -(-height // 4) * -(-width // 4) * (8 if format == "bc1" else 16)
    found = decode_blocks(format, blocks, width, height)
    assert found.shape == texels.shape and found.dtype == np.uint8
    assert np.abs(found.astype(int) - texels).max() <= allowed


def test_a_uniform_block_of_bc1_is_known():
    """Both end colours are red, 31 << 11, and every index is the same."""
    red = np.zeros((4, 4, 3), np.uint8)
    red[..., 0] = 255
    found = decode_blocks("bc1", encode_blocks("bc1", red), 4, 4)
    np.testing.assert_array_equal(found, red)
    by_hand = bytes([0x00, 0xF8, 0x00, 0x00, 0, 0, 0, 0])
    np.testing.assert_array_equal(decode_blocks("bc1", by_hand, 4, 4), red)


def test_bc7_weighs_its_channels_alike():
    """With the encoder's default weights of perceived colour, blue has more error than green."""
    texels = np.random.default_rng(0).integers(0, 256, (64, 64, 3)).astype(np.uint8)
    found = decode_blocks("bc7", encode_blocks("bc7", texels), 64, 64)
    rms = np.sqrt(np.mean((found.astype(float) - texels) ** 2, axis=(0, 1)))
    assert rms.max() < 1.15 * rms.min()


@pytest.mark.parametrize(
    ("format", "texels", "message"),
    [
        ("bc9", gradient(4, 4, 3), "no block format is called 'bc9': allowed are bc1, bc5, bc7"),
        ("bc7", gradient(4, 4, 2), r"shape \(4, 4, 2\): allowed for bc7 is \(height, width, 3\)"),
        ("bc5", gradient(4, 4, 3), r"allowed for bc5 is \(height, width, 2\)"),
        ("bc1", gradient(4, 4, 3).astype(float), "texels of type float64: allowed is uint8"),
        ("bc1", np.zeros((0, 4, 3), np.uint8), "height 0: allowed are whole numbers from 1"),
    ],
)
def test_what_is_no_image_is_refused(format, texels, message):
    with pytest.raises(ValueError, match=message):
        encode_blocks(format, texels)


def test_another_number_of_bytes_is_refused():
    """The decoder in C would read beyond the end."""
    blocks = encode_blocks("bc7", gradient(8, 8, 3))
    with pytest.raises(ValueError, match="63 bytes of bc7 for 8×8: allowed are 64"):
        decode_blocks("bc7", blocks[:-1], 8, 8)
    with pytest.raises(ValueError, match="64 bytes of bc7 for 16×8: allowed are 128"):
        decode_blocks("bc7", blocks, 16, 8)
    with pytest.raises(ValueError, match="width 0: allowed are whole numbers from 1 to 16384"):
        decode_blocks("bc7", b"", 0, 8)
