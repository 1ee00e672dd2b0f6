import os
import struct
import zlib

import numpy as np
import pytest
from PIL import Image as Pillow

from shadefit.images import (
    MAX_EDGE,
    convert_colour_space,
    image_of,
    optional_library,
    read_image,
    require_channels,
    require_power_of_two,
    require_same_size,
    write_image,
)
from shadefit.images import optional_libraries as libraries


def _random(channels, largest, seed=0):
    codes = np.random.default_rng(seed).integers(0, largest + 1, (6, 5, channels))
    return codes, codes.astype(np.float32) / np.float32(largest)


def _png(width, height, *, depth=8, kind=2, data=b""):
    def chunk(name, body):
        return (
            struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        )

    header = struct.pack(">2I5B", width, height, depth, kind, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_png_files_keep_every_bit(tmp_path, channels, bits):
    _, pixels = _random(channels, 2**bits - 1)
    path = tmp_path / "a.png"
    write_image(path, image_of(pixels, "srgb", "a"), bits)
    read = read_image(path, "srgb")
    np.testing.assert_array_equal(read.pixels, pixels)
    assert read.colour_space == "srgb"
    # Pillow's own reader, which keeps the high byte of colours, reads the same file.
    with Pillow.open(path) as other:
        assert other.info["srgb"] == 0
        other.load()


@pytest.mark.parametrize("bits", [8, 16])
def test_tall_png_files_keep_every_bit(tmp_path, bits):
    """Rows are worked on in parts."""
    codes = np.random.default_rng(1).integers(0, 2**bits, (600, 3, 3))
    pixels = (codes / np.float32(2**bits - 1)).astype(np.float32)
    write_image(tmp_path / "a.png", image_of(pixels, "linear", "a"), bits)
    np.testing.assert_array_equal(read_image(tmp_path / "a.png", "linear").pixels, pixels)


def test_png_files_of_another_writer_are_read(tmp_path):
    codes, pixels = _random(3, 255)
    path = tmp_path / "a.png"
    Pillow.fromarray(codes.astype(np.uint8)).save(path)
    np.testing.assert_array_equal(read_image(path, "linear").pixels, pixels)
    grey, values = _random(1, 65535)
    Pillow.fromarray(grey[..., 0].astype(np.uint16)).save(path)
    np.testing.assert_array_equal(read_image(path, "linear").pixels, values)
    # A palette and one bit
    Pillow.fromarray(codes.astype(np.uint8)).quantize(64, dither=0).save(path)
    np.testing.assert_array_equal(read_image(path, "srgb").pixels, pixels)
    Pillow.fromarray(grey[..., 0] > 30000).save(path)
    np.testing.assert_array_equal(read_image(path, "srgb").pixels[..., 0], grey[..., 0] > 30000)


def test_interlaced_16_bit_colours_are_read(tmp_path):
    # One pixel is the first of the seven passes.
    row = struct.pack(">B3H", 0, 258, 772, 65535)
    data = _png(1, 1, depth=16, data=zlib.compress(row))
    path = tmp_path / "a.png"
    path.write_bytes(data)
    expected = np.float32([258, 772, 65535]) / np.float32(65535)
    np.testing.assert_array_equal(read_image(path, "linear").pixels[0, 0], expected)


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_exr_files_keep_floats(tmp_path, channels):
    pixels = np.random.default_rng(1).normal(size=(4, 7, channels)).astype(np.float32) * 100
    path = tmp_path / "a.exr"
    write_image(path, image_of(pixels, "linear", "a"))
    np.testing.assert_array_equal(read_image(path, "linear").pixels, pixels)
    with pytest.raises(ValueError, match="linear"):
        read_image(path, "srgb")
    with pytest.raises(ValueError, match="linear"):
        write_image(path, image_of(pixels, "srgb", "a"))


def test_compressed_half_float_exr_files_are_read(tmp_path):
    library = optional_library("OpenEXR")
    pixels = np.random.default_rng(1).uniform(size=(8, 8, 3)).astype(np.float16)
    header = {"compression": library.PIZ_COMPRESSION, "type": library.scanlineimage}
    path = tmp_path / "a.exr"
    library.File(header, {"RGB": pixels}).write(str(path))
    np.testing.assert_array_equal(read_image(path, "linear").pixels, pixels.astype(np.float32))
    library.File(header, {"depth": pixels[..., 0].copy()}).write(str(path))
    with pytest.raises(ValueError, match="channels depth: allowed"):
        read_image(path, "linear")


def test_dds_files_are_read(tmp_path):
    codes, pixels = _random(4, 255)
    path = tmp_path / "a.dds"
    Pillow.fromarray(codes.astype(np.uint8)).save(path)
    np.testing.assert_array_equal(read_image(path, "srgb").pixels, pixels)
    flat = np.full((8, 8, 3), 255, np.uint8)
    Pillow.fromarray(flat).save(path, pixel_format="DXT1")
    np.testing.assert_array_equal(read_image(path, "srgb").pixels[..., :3], np.ones((8, 8, 3)))
    Pillow.fromarray(flat).save(path, pixel_format="BC5")
    np.testing.assert_array_equal(read_image(path, "linear").pixels, np.ones((8, 8, 2)))


@pytest.mark.parametrize("name", ["a.png", "a.exr", "a.dds"])
def test_broken_files_get_one_line(tmp_path, name):
    path = tmp_path / name
    pixels = np.random.default_rng(0).uniform(size=(64, 64, 4)).astype(np.float32)
    if name == "a.dds":
        Pillow.fromarray((255 * pixels).astype(np.uint8)).save(path)
    else:
        write_image(path, image_of(pixels, "linear", "a"))
    whole = path.read_bytes()
    rng = np.random.default_rng(5)
    for length in (0, 1, 4, 20, 100, len(whole) // 2, len(whole) - 60):
        path.write_bytes(whole[:length])
        with pytest.raises(ValueError, match=name) as refused:
            read_image(path, "linear")
        assert "\n" not in str(refused.value)
    for _ in range(40):
        broken = bytearray(whole)
        for place in rng.integers(0, 400, 6):
            broken[place] = rng.integers(256)
        path.write_bytes(broken)
        try:
            assert np.all(np.isfinite(read_image(path, "linear").pixels))
        except ValueError as error:
            assert name in str(error)
            assert "\n" not in str(error)


@pytest.mark.parametrize("size", [(MAX_EDGE + 1, 1), (1, MAX_EDGE + 1), (2**31 - 1, 2**31 - 1)])
def test_huge_images_are_refused_before_they_are_decoded(tmp_path, size):
    path = tmp_path / "a.png"
    path.write_bytes(_png(*size))
    with pytest.raises(ValueError, match=f"×{size[1]} pixels: allowed are {MAX_EDGE} an edge"):
        read_image(path, "linear")
    path = tmp_path / "a.dds"
    Pillow.fromarray(np.zeros((4, 4, 3), np.uint8)).save(path)
    data = bytearray(path.read_bytes())
    data[12:20] = struct.pack("<2I", size[1], size[0])
    path.write_bytes(data)
    with pytest.raises(ValueError, match=f"{size[0]}×{size[1]} pixels"):
        read_image(path, "linear")


def test_pipes_devices_and_folders_are_refused(tmp_path):
    pipe = tmp_path / "pipe.png"
    os.mkfifo(pipe)
    device = tmp_path / "device.png"
    device.symlink_to("/dev/zero")
    folder = tmp_path / "folder.png"
    folder.mkdir()
    for path in (pipe, device, folder):
        with pytest.raises(ValueError, match="no regular file"):
            read_image(path, "linear")
    with pytest.raises(ValueError, match="No such file"):
        read_image(tmp_path / "absent.png", "linear")
    with pytest.raises(ValueError, match=r"\.png, \.exr, \.dds"):
        read_image(tmp_path / "a.gif", "linear")


def test_the_colour_space_is_said(tmp_path):
    with pytest.raises(ValueError, match="colour space is not said: say srgb or linear"):
        read_image(tmp_path / "a.png", None)
    with pytest.raises(ValueError, match="adobe is unknown"):
        read_image(tmp_path / "a.png", "adobe")


def test_colour_spaces_are_inverse_and_keep_alpha():
    pixels = np.random.default_rng(0).uniform(-0.2, 1.2, (9, 9, 4))
    linear = convert_colour_space(pixels, "srgb", "linear")
    np.testing.assert_array_equal(linear[..., 3], pixels[..., 3])
    # The standard's two pieces meet to 1e-8 only.
    np.testing.assert_allclose(convert_colour_space(linear, "linear", "srgb"), pixels, atol=3e-8)
    half = convert_colour_space(np.full((1, 1, 1), 0.5), "srgb", "linear")
    np.testing.assert_allclose(half, 0.21404114, atol=1e-8)


def test_requirements_name_the_file_and_what_is_allowed():
    image = image_of(np.zeros((4, 6)), "linear", "a.png")
    with pytest.raises(ValueError, match=r"a\.png: 1 channels \(grey\): allowed: 3 \(RGB\), 4"):
        require_channels(image, 3, 4)
    require_channels(image, 1)
    with pytest.raises(ValueError, match=r"a\.png: 6×4 pixels: a mip chain"):
        require_power_of_two(image)
    require_power_of_two(image_of(np.zeros((4, 64)), "linear", "b.png"))
    with pytest.raises(ValueError, match=r"c\.png: 4×4 pixels, but a\.png has 6×4"):
        require_same_size(image, image_of(np.zeros((4, 4)), "linear", "c.png"))
    for bad in (np.nan, np.inf, 1e300):
        with pytest.raises(ValueError, match="NaN or infinite"):
            image_of(np.full((2, 2), bad), "linear", "a")
    with pytest.raises(ValueError, match="shape"):
        image_of(np.zeros((2, 2, 5)), "linear", "a")


def test_what_does_not_fit_into_a_file_is_refused(tmp_path):
    image = image_of(np.full((2, 2), 1.5), "linear", "a")
    with pytest.raises(ValueError, match="outside"):
        write_image(tmp_path / "a.png", image)
    with pytest.raises(ValueError, match="12 bits"):
        write_image(tmp_path / "a.png", image, 12)
    with pytest.raises(ValueError, match=r"\.png, \.exr"):
        write_image(tmp_path / "a.tga", image)
    assert list(tmp_path.iterdir()) == []


def test_an_absent_library_says_what_to_install(monkeypatch):
    def absent(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(libraries.importlib, "import_module", absent)
    with pytest.raises(ValueError, match=r"quicktex: install it by pip install 'shadefit\[maps\]'"):
        optional_library("quicktex.s3tc.bc1")
    with pytest.raises(ValueError, match=r"skimage: install it by pip install scikit-image$"):
        optional_library("skimage.data")


def test_each_optional_module_has_a_line_on_how_to_install_it():
    tops = {module.partition(".")[0] for module in libraries._LIBRARIES}
    assert tops == set(libraries._INSTALLED_BY)
