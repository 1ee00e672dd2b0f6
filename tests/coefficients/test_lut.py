"""Lookup textures: how they are filtered, their errors, and their files read back."""

import io
import struct
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from scipy.interpolate import RegularGridInterpolator

from coefficients.lut import FORMATS, Lut, bake, errors_of, require_format, write_lut
from coefficients.lut.texels import decoded, encoded
from coefficients.lut.texture import fraction_on, texel_centres
from fitting import Domain
from fitting.points.scattered import checking_points, judging_points
from integrals import Axis
from tests.fitting.toys import AXES, TOY

X, Y = AXES
Z = Axis("z", 1.0, 2.0)
LOG = Axis("d", 0.01, 1.0, scale="logarithmic")
SQUARE = Axis("s", 0.5, 2.0, scale="square")
RANDOM = np.random.default_rng(5)


def points_in(axes, count=200) -> np.ndarray:
    return np.stack([RANDOM.uniform(axis.lower, axis.upper, count) for axis in axes], axis=1)


def wave(points: np.ndarray) -> np.ndarray:
    return 0.5 + 0.4 * np.sin(points.sum(axis=1))


# Filtering


@pytest.mark.parametrize("axes", [(X,), (X, Y), (X, Y, Z)])
def test_the_linear_filter_is_that_of_scipy(axes):
    lut = bake(wave, axes, (5, 4, 6)[: len(axes)], weight_bits=None)
    lines = [np.linspace(axis.lower, axis.upper, n) for axis, n in zip(axes, lut.size, strict=True)]
    points = points_in(axes)
    expected = RegularGridInterpolator(lines, lut.texels)(points)
    np.testing.assert_allclose(lut(points), expected, atol=1e-14)


def test_the_cubic_filter_is_that_of_a_catmull_rom_spline():
    lut = bake(wave, (X,), (11,), filter="cubic")
    x, values = np.linspace(0, 1, 9), lut.texels
    # The cubic through two texels with slopes by central differences. There is a border of one.
    points = np.linspace(0, 1, 65)[:, None]
    k = np.minimum((points[:, 0] * 8).astype(int), 7)
    t = points[:, 0] * 8 - k
    k = k + 1
    slope = lambda i: (values[i + 1] - values[i - 1]) / 2  # noqa: E731
    expected = (
        (2 * t**3 - 3 * t**2 + 1) * values[k]
        + (t**3 - 2 * t**2 + t) * slope(k)
        + (3 * t**2 - 2 * t**3) * values[k + 1]
        + (t**3 - t**2) * slope(k + 1)
    )
    np.testing.assert_allclose(lut(points), expected, atol=1e-14)
    np.testing.assert_allclose(lut(x[:, None]), values[1:-1], atol=1e-15)


@pytest.mark.parametrize("axes", [(X,), (X, Y), (X, Y, Z)])
def test_the_cubic_filter_is_exact_for_parabolas_up_to_the_ends(axes):
    parabola = lambda p: (p * p - p).sum(axis=1) + (p[:, 0] * p[:, -1] if len(axes) > 1 else 0)  # noqa: E731
    lut = bake(parabola, axes, (7, 8, 6)[: len(axes)], filter="cubic")
    points = np.concatenate([points_in(axes), [[a.lower for a in axes], [a.upper for a in axes]]])
    # Texels are float32, and values are at most 10.
    np.testing.assert_allclose(lut(points), parabola(points), atol=5e-6)
    assert lut.border == 1
    assert np.isnan(lut.points).any(axis=1).sum() == lut.texels.size - np.prod(
        np.array(lut.size) - 2
    )


@pytest.mark.parametrize("filtered", ["linear", "cubic"])
@pytest.mark.parametrize("centres", ["ends", "half"])
def test_texels_are_met_at_their_centres_and_clamped_beyond(filtered, centres):
    lut = bake(wave, (X, Y), (6, 5), filtered, centres=centres)
    points = lut.points
    inside = ~np.isnan(points).any(axis=1)
    np.testing.assert_allclose(lut(points[inside]), lut.texels.ravel()[inside], atol=1e-14)
    corner = lut(np.array([[X.lower, Y.lower]]))[0]
    if centres == "ends":
        assert corner == pytest.approx(lut.texels[lut.border, lut.border], abs=1e-15)
    elif filtered == "linear":
        # The corner is half a texel outside of the first centre.
        assert corner == lut.texels[0, 0]
        assert lut(np.array([[X.lower + 0.05, Y.lower + 0.1]]))[0] == corner


def test_coordinates_of_the_hardware_have_few_bits():
    ramp = Lut((X,), np.array([0.0, 1.0]), weight_bits=8)
    points = np.linspace(0, 1, 1001)[:, None]
    found = ramp(points)
    np.testing.assert_array_equal(found * 256, np.round(found * 256))
    assert np.abs(found - points[:, 0]).max() == pytest.approx(1 / 512, rel=0.02)
    exact = replace(ramp, weight_bits=None)
    np.testing.assert_allclose(exact(points), points[:, 0], atol=1e-15)


@pytest.mark.parametrize("axis", [X, Y, LOG, SQUARE])
def test_fractions_are_the_inverse_of_places(axis):
    t = np.linspace(0, 1, 17)
    np.testing.assert_allclose(fraction_on(axis, axis.place(t)), t, atol=1e-14)


@pytest.mark.parametrize("axis", [X, Y, LOG, SQUARE])
@pytest.mark.parametrize("filtered", ["linear", "cubic"])
@pytest.mark.parametrize("centres", ["ends", "half"])
def test_texture_coordinates_of_centres_are_those_of_the_texels(axis, filtered, centres):
    lut = bake(wave, (axis,), (8,), filtered, centres=centres)
    (coordinate,) = lut.coordinates
    # The centre of texel k is at (k + ½)/n.
    inside = ~np.isnan(lut.points[:, 0])
    expected = (np.arange(8) + 0.5) / 8
    np.testing.assert_allclose(
        coordinate.at(lut.points[inside, 0]), expected[inside], rtol=1e-13, atol=1e-15
    )


def test_texture_coordinates_are_written_and_counted():
    texts = {
        X: ("0.75 x + 0.125", 2),
        Y: ("0.25 y + 0.375", 2),
        LOG: ("0.162860431 log(d) + 0.875", 3),
        SQUARE: ("0.612372436 sqrt(s - 0.5) + 0.125", 4),
    }
    for axis, (text, operations) in texts.items():
        (coordinate,) = bake(wave, (axis,), (4,)).coordinates
        assert (coordinate.text(axis.symbol), coordinate.operations) == (text, operations)
    (bare,) = bake(wave, (X,), (4,), centres="half").coordinates
    assert (bare.text("x"), bare.operations) == ("x", 0)


def test_texels_follow_the_scale_of_the_axis():
    lut = bake(lambda p: np.log(p[:, 0]), (LOG,), (3,), weight_bits=None)
    np.testing.assert_allclose(lut.points[:, 0], [0.01, 0.1, 1], rtol=1e-14)
    # A logarithm is linear on a logarithmic axis; float32 texels are off by half a unit.
    points = points_in((LOG,))
    np.testing.assert_allclose(lut(points), np.log(points[:, 0]), atol=3e-7)


# Texels


@pytest.mark.parametrize(
    ("texel", "step"), [("float32", 2.0**-25), ("float16", 2.0**-12), ("unorm16", 0.5 / 65535),
                        ("unorm8", 0.5 / 255)]
)  # fmt: skip
def test_texels_are_rounded_to_their_type(texel, step):
    values = RANDOM.uniform(0, 1, (7, 5))
    stored, span = encoded(values, texel)
    assert span == (0.0, 1.0)
    difference = np.abs(decoded(stored, span) - values).max()
    assert step / 2 < difference <= step


def test_values_outside_of_0_and_1_widen_the_span_of_unorm_texels():
    stored, span = encoded(np.array([-1.0, 0.25, 3.0]), "unorm8")
    assert span == (-1.0, 3.0)
    assert stored.tolist() == [0, 80, 255]
    np.testing.assert_allclose(decoded(stored, span), [-1, 0.25, 3], atol=4 / 510)
    assert decoded(*encoded(np.full(3, 7.0), "unorm8")).tolist() == [7, 7, 7]
    with pytest.raises(ValueError, match="value 70000: allowed in float16 are ±65504"):
        encoded(np.array([70000.0]), "float16")


def test_a_texel_without_a_value_takes_one_from_further_in():
    def hole(points):
        values = wave(points)
        values[(points == 0).all(axis=1)] = np.nan
        return values

    axes = (X, replace(Y, lower=0.0))
    lut = bake(hole, axes, (4, 4))
    assert lut.moved == 1
    assert lut.texels[0, 0] == pytest.approx(wave(np.array([[0.1 / 4, 2 * 0.1 / 4]]))[0], rel=1e-7)
    with pytest.raises(ValueError, match=r"no value at x = 0, y = 0: a LUT needs values"):
        bake(lambda p: np.where(p[:, 0] < 0.1, np.inf, 1.0), axes, (4, 4))


# Errors and costs


@pytest.mark.parametrize("filtered", ["linear", "cubic"])
def test_errors_are_the_largest_of_the_points_that_judge_forms(filtered):
    lut = bake(TOY.values, AXES, (17, 17), filtered)
    errors = errors_of(lut, TOY)
    points, exact = judging_points(Domain(TOY, AXES))
    difference = lut(points) - exact
    assert errors.rms == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-12)
    assert errors.largest >= np.abs(difference).max()
    more, exact = checking_points(Domain(TOY, AXES), 20200717)
    assert errors.largest >= np.abs(lut(more) - exact).max()
    # Linear: h²/8 of the second derivatives, 3 e^(−x) h²/8 each, and the rounding of coordinates.
    assert errors.largest < (3 * (1 / 16) ** 2 + (3 / 16) ** 2) / 8 + 3 * (1 / 16 + 3 / 16) / 512


def test_an_error_falls_with_the_square_of_the_size():
    sizes = [bake(TOY.values, AXES, (n, n), weight_bits=None) for n in (9, 17)]
    coarse, fine = (errors_of(lut, TOY).largest for lut in sizes)
    assert coarse / fine == pytest.approx(4, rel=0.1)


def test_the_rounding_of_texels_is_stated():
    for texel, most in (("float16", 2.0**-12), ("unorm8", 0.5 / 255)):
        lut = bake(wave, (X, Y), (9, 9), texel=texel)
        exact = wave(lut.points).reshape(9, 9)
        assert lut.rounding == np.abs(lut.texels - exact).max()
        assert 0.5 * most < lut.rounding <= most


def test_the_cost_of_a_lookup_is_counted():
    lut = bake(wave, (X, Y), (8, 4), texel="float16")
    assert (lut.size, lut.bytes, lut.fetches, lut.operations) == ((8, 4), 64, 1, 4)
    # x is a texture coordinate itself; y is scaled and moved.
    assert bake(wave, (X, Y), (8, 4), centres="half").operations == 2
    assert bake(wave, (LOG,), (8,)).operations == 3
    cubic = bake(wave, (X, Y), (8, 5), filter="cubic")
    assert (cubic.fetches, cubic.operations) == (16, 4 + 2 * 18 + 5 * 7)


@pytest.mark.parametrize(
    ("axes", "size", "message"),
    [
        ((X, Y, Z, LOG), (4, 4, 4, 4), "4 axes .*: a texture has at most 3"),
        ((X, Y), (4,), "size 4: expected are 2 numbers, for x, y"),
        ((X,), (1,), "size 1: allowed are 2 or more an axis"),
        ((X, Y), (1 << 13, 1 << 12), "size 8192x4096: allowed are"),
        ((Axis("t", 0, np.inf),), (4,), r"t in \[0, ∞\): a LUT needs a finite domain"),
        ((replace(X, scale="logarithmic"),), (4,), "a logarithmic axis begins above 0"),
    ],
)
def test_what_is_no_texture_is_refused(axes, size, message):
    with pytest.raises(ValueError, match=message):
        bake(wave, axes, size)


def test_a_cubic_texture_needs_three_texels_within_its_border():
    with pytest.raises(ValueError, match="size 4: allowed are 5 or more an axis"):
        bake(wave, (X,), (4,), filter="cubic")


# Files


def lut_of(dimensions: int, texel: str) -> Lut:
    size = (5, 3, 2)[:dimensions]
    return bake(wave, (X, Y, Z)[:dimensions], size, texel=texel)


def read_ktx2(data: bytes) -> np.ndarray:
    """Read a KTX2 file by the tables of its specification."""
    assert data[:12] == bytes([0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32, 0x30, 0xBB, 13, 10, 26, 10])
    kind, size, width, height, depth, layers, faces, levels, scheme = struct.unpack_from(
        "<9I", data, 12
    )
    assert (layers, faces, levels, scheme) == (0, 1, 1, 0)
    dfd, dfd_length, kvd, kvd_length, sgd, sgd_length = struct.unpack_from("<4I2Q", data, 48)
    assert (sgd, sgd_length) == (0, 0)
    begin, length, uncompressed = struct.unpack_from("<3Q", data, 80)
    assert (begin % 4, begin % size, length) == (0, 0, uncompressed)
    assert begin + length == len(data)
    assert dfd == 104
    assert kvd == dfd + dfd_length
    assert begin - (kvd + kvd_length) in range(4)
    total, _, version, block = struct.unpack_from("<2I2H", data, dfd)
    assert (total, version, block) == (dfd_length, 2, 40)
    assert data[dfd + 20] == size
    (bits,) = struct.unpack_from("<B", data, dfd + 30)
    assert bits == 8 * size - 1
    keys, at = [], kvd
    while at < kvd + kvd_length:
        (count,) = struct.unpack_from("<I", data, at)
        keys.append(data[at + 4 : at + 4 + count].split(b"\0")[0].decode())
        at += 4 + count + -count % 4
    assert keys == ["KTXorientation", "KTXwriter"]
    dtype = {9: "u1", 70: "<u2", 76: "<f2", 100: "<f4"}[kind]
    shape = [n for n in (depth, height, width) if n]
    return np.frombuffer(data, dtype, offset=begin).reshape(shape)


def read_dds(data: bytes) -> np.ndarray:
    """Read a DDS file with a DX10 header by the tables of its documentation."""
    magic, size, flags, height, width, pitch, depth = struct.unpack_from("<4s6I", data)
    assert (magic, size, flags & 0x1007) == (b"DDS ", 124, 0x1007)
    length, kind, name = struct.unpack_from("<2I4s", data, 76)
    assert (length, kind, name) == (32, 4, b"DX10")
    code, dimension, misc, count, _ = struct.unpack_from("<5I", data, 128)
    assert (misc, count) == (0, 1)
    dtype = np.dtype({61: "u1", 56: "<u2", 54: "<f2", 41: "<f4"}[code])
    assert pitch == width * dtype.itemsize
    assert bool(flags & 0x800000) == (dimension == 4)
    shape = {2: (width,), 3: (height, width), 4: (depth, height, width)}[dimension]
    return np.frombuffer(data, dtype, offset=148).reshape(shape)


@pytest.mark.parametrize("dimensions", [1, 2, 3])
@pytest.mark.parametrize("texel", ["float32", "float16", "unorm16", "unorm8"])
@pytest.mark.parametrize(("key", "read"), [("dds", read_dds), ("ktx2", read_ktx2)])
def test_textures_are_read_back_bit_for_bit(key, read, texel, dimensions):
    lut = lut_of(dimensions, texel)
    # The first axis is the width.
    np.testing.assert_array_equal(read(write_lut(lut, key)), lut.stored.T)


def test_pillow_opens_the_dds_header():
    data = write_lut(lut_of(2, "unorm8"), "dds")
    # Pillow knows the format of the file, but not this kind of texel.
    with pytest.raises(NotImplementedError, match="Unimplemented DXGI format 61"):
        Image.open(io.BytesIO(data), formats=["DDS"])


@pytest.mark.parametrize("dimensions", [1, 2])
def test_pillow_reads_the_png(dimensions):
    lut = lut_of(dimensions, "unorm16")
    image = Image.open(io.BytesIO(write_lut(lut, "png16")))
    assert image.mode == "I;16"
    np.testing.assert_array_equal(np.asarray(image), np.atleast_2d(lut.stored.T))


@pytest.mark.parametrize(("texel", "kind", "dtype"), [("float16", 1, "<f2"), ("float32", 2, "<f4")])
def test_exr_files_hold_half_and_full_floats(texel, kind, dtype):
    lut = lut_of(2, texel)
    data = write_lut(lut, "exr")
    at = data.index(b"chlist\0") + 7 + 4
    assert data[at : at + 2] == b"Y\0"
    assert struct.unpack_from("<i", data, at + 2) == (kind,)
    # Each line has its number and its length before its texels; there is no compression.
    width, height = lut.size
    line = 8 + width * np.dtype(dtype).itemsize
    lines = [data[len(data) - (height - k) * line :][:line] for k in range(height)]
    assert [struct.unpack_from("<2i", each) for each in lines] == [
        (k, line - 8) for k in range(height)
    ]
    rows = [np.frombuffer(each, dtype, offset=8) for each in lines]
    np.testing.assert_array_equal(np.stack(rows), lut.stored.T)


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_arrays_and_text_have_the_order_of_the_axes(dimensions):
    lut = lut_of(dimensions, "float32")
    array = np.load(io.BytesIO(write_lut(lut, "npy")), allow_pickle=False)
    np.testing.assert_array_equal(array, lut.stored)
    first, *lines = write_lut(lut, "csv").decode().splitlines()
    assert first == ",".join([*"xyz"[:dimensions], "value"])
    rows = np.array([line.split(",") for line in lines], float)
    np.testing.assert_array_equal(rows[:, :-1], lut.points)
    np.testing.assert_array_equal(rows[:, -1], lut.texels.ravel())


@pytest.mark.parametrize(
    ("key", "texel", "dimensions", "message"),
    [
        ("tga", None, 2, "format 'tga': allowed are exr, png16, npy, csv, dds, ktx2"),
        ("png16", "float16", 2, "png16 cannot hold float16: allowed are unorm16"),
        ("exr", "unorm8", 2, "exr cannot hold unorm8: allowed are float16, float32"),
        ("exr", None, 3, "exr cannot hold 3 dimensions: allowed are npy, csv, dds, ktx2"),
        ("npy", None, 4, "4 arguments: a texture has at most 3"),
    ],
)
def test_what_a_format_cannot_hold_is_refused(key, texel, dimensions, message):
    with pytest.raises(ValueError, match=message):
        require_format(key, texel, dimensions)


def test_every_format_has_usual_texels():
    assert {key: require_format(key, None, 1) for key in FORMATS} == {
        "exr": "float16",
        "png16": "unorm16",
        "npy": "float32",
        "csv": "float32",
        "dds": "float16",
        "ktx2": "float16",
    }
    assert texel_centres((2, 2), "half").tolist() == [
        [0.25, 0.25], [0.25, 0.75], [0.75, 0.25], [0.75, 0.75]
    ]  # fmt: skip
