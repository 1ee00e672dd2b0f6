"""Maps of anisotropic roughness: mip levels, DDS files, errors, and `shadefit maps encode`."""

import io
import json

import numpy as np
import pytest
from PIL import Image

from coefficients.textures.dds import write_coloured_dds
from shadefit.cli import main
from shadefit.images import image
from shadefit.maps.aniso_map import decoded, encode_level, mip_entries, quantised, write_map
from shadefit.maps.encoding_errors import (
    errors_of,
    least_eigenvalue_between,
    mixed_error,
    mixture_distance,
    random_points,
    worst_texel,
)
from shadefit.material_outputs import MapsEncodeOutput
from shading.maps.encode import entries_of_widths
from shading.maps.total_variation import total_variation


@pytest.fixture(scope="module")
def entries() -> np.ndarray:
    """A brushed map of 16×32 texels, whose direction turns."""
    y, x = np.mgrid[0:16, 0:32]
    return entries_of_widths(0.3 + 0.01 * y, np.full((16, 32), 0.08), 0.05 * x)


@pytest.fixture
def files(tmp_path):
    y, x = np.mgrid[0:16, 0:16]
    names = []
    for name, plane in (("t", 60 + 4 * y), ("b", 20 + y), ("d", 8 * x)):
        names.append(tmp_path / f"{name}.png")
        Image.fromarray(plane.astype(np.uint8)).save(names[-1])
    return names


def test_mip_levels_are_means_of_matrices(entries):
    levels = mip_entries(entries)
    assert [each.shape[:2] for each in levels] == [
        (16, 32),
        (8, 16),
        (4, 8),
        (2, 4),
        (1, 2),
        (1, 1),
    ]
    np.testing.assert_allclose(levels[-1][0, 0], entries.mean(axis=(0, 1)), rtol=1e-14)
    np.testing.assert_allclose(levels[1][0, 0], entries[:2, :2].mean(axis=(0, 1)), rtol=1e-14)
    with pytest.raises(
        ValueError, match="a map of 32×12 texels has no mip levels: allowed are pow"
    ):
        mip_entries(entries[:12])


@pytest.mark.parametrize("format", ["bc7", "bc1", "rgba8"])
def test_a_file_has_the_texels_of_every_level(entries, format):
    levels = [encode_level(each, "quarter-root", format) for each in mip_entries(entries)]
    data = write_map(levels, format)
    # The magic number, two headers, and the levels
    assert len(data) == 4 + 124 + 20 + sum(len(level.data) for level in levels)
    read = Image.open(io.BytesIO(data))
    assert read.size == (32, 16)
    # Pillow's decoder of blocks is a third implementation.
    np.testing.assert_array_equal(np.asarray(read.convert("RGB")), levels[0].texels)
    # A smaller level alone is the file of its size.
    last = Image.open(io.BytesIO(write_map(levels[1:], format)))
    np.testing.assert_array_equal(np.asarray(last.convert("RGB")), levels[1].texels)


def test_a_level_of_another_size_is_refused():
    with pytest.raises(ValueError, match="level 1 has 5 bytes: allowed are 16 for 4×2 in bc7"):
        write_coloured_dds([bytes(2 * 16), bytes(5)], 8, 4, "bc7")


@pytest.mark.parametrize("rows", [5, 256])
def test_errors_are_those_of_the_texels_that_are_read(entries, monkeypatch, rows):
    monkeypatch.setattr(image, "_ROWS", rows)
    level = encode_level(entries, "published", "rgba8")
    np.testing.assert_array_equal(level.texels, quantised(entries, "published"))
    error = total_variation(entries, decoded("published", level.texels / 255)[..., :3])
    assert level.largest == error.max() and level.mean == error.mean()
    with pytest.raises(ValueError, match="no format is called 'bc3': allowed are bc7, bc1, rgba8"):
        encode_level(entries, "published", "bc3")
    with pytest.raises(ValueError, match="no encoding is called 'x'"):
        decoded("x", level.texels / 255)


# The largest total variations of 8 bits that the searches find, rounded up
WORST = {"published": 0.55, "stereographic": 0.044, "quarter-root": 0.04, "logarithmic": 0.034}


@pytest.mark.parametrize("name", WORST)
def test_the_worst_texel_of_eight_bits_is_known(name):
    points = random_points(40_000)
    found, worst = errors_of(name, points, 8), worst_texel(name, 8, starts=100, rounds=30)
    # The search finds more than random texels do, at a point where the error is this one.
    assert 0.99 * found.largest <= worst.error <= WORST[name]
    assert found.mean < found.percentile < found.largest
    # The published one is at least twelve times worse than any other.
    assert worst.error > 0.5 if name == "published" else 12 * worst.error < 0.545
    assert errors_of(name, points, 10).largest < found.largest / 3


def test_mixtures_of_the_published_texels_have_no_negative_eigenvalue():
    """They have some if Sxy itself is stored."""
    least, fraction = least_eigenvalue_between(20_000, stores_sxy=False)
    assert least >= -1e-15 and fraction == 0
    least, fraction = least_eigenvalue_between(20_000, stores_sxy=True)
    assert least < -0.05 and 0.05 < fraction < 0.2


def test_errors_of_mixtures():
    first = entries_of_widths(np.array(0.87), np.array(0.04), np.array(0.0))
    second = entries_of_widths(np.array(0.87), np.array(0.04), np.array(np.pi / 18))
    assert mixture_distance(first, first, first) == pytest.approx(0, abs=1e-12)
    assert mixture_distance(first, first, second) == pytest.approx(
        total_variation(first, second), abs=2e-4
    )
    # No single lobe is like these two: the mean of their matrices is not either.
    assert mixture_distance(first, second, (first + second) / 2) == pytest.approx(0.282, abs=1e-3)
    assert mixed_error("quarter-root", first, second) == pytest.approx(0.344, abs=0.01)


def test_the_command_writes_a_texture(files, tmp_path, capsys):
    out = tmp_path / "aniso.dds"
    with pytest.raises(SystemExit) as status:
        main(["maps", "encode", *map(str, files), "-o", str(out), "--json"])
    assert status.value.code == 0
    found = MapsEncodeOutput.model_validate(json.loads(capsys.readouterr().out))
    assert [(each.width, each.bytes) for each in found.levels] == [
        *((16, 256), (8, 64), (4, 16), (2, 16), (1, 16)),
    ]
    assert 0 < found.levels[0].mean < found.levels[0].largest < 0.2
    with Image.open(out) as image:
        assert image.size == (16, 16)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (["--encoding", "other"], "'other' is not one of"),
        (["-o", "map.png"], "map.png: allowed is a file .dds"),
    ],
)
def test_bad_options_are_one_line(files, tmp_path, monkeypatch, capsys, change, message):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as status:
        main(["maps", "encode", *map(str, files), *change])
    assert status.value.code == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1


def test_the_group_without_a_command_is_one_line(capsys):
    with pytest.raises(SystemExit) as status:
        main(["maps"])
    assert status.value.code == 2
    assert capsys.readouterr().err == "shadefit: Missing command.\n"


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("missing", "No such file"),
        ("colour", "3 channels (RGB): allowed: 1 (grey)"),
        ("size", "both need the same size"),
        ("odd", "a mip chain needs powers of two"),
        ("text", "allowed are the files .png, .exr, .dds"),
    ],
)
def test_bad_images_are_one_line(files, tmp_path, monkeypatch, capsys, kind, message):
    monkeypatch.chdir(tmp_path)
    shapes = {"colour": (16, 16, 3), "size": (8, 8), "odd": (16, 12)}
    if kind == "missing":
        files[1].unlink()
    elif kind == "text":
        files[1] = tmp_path / "b.txt"
        files[1].write_text("0.5", encoding="utf-8")
    else:
        for path in files if kind == "odd" else files[1:2]:
            Image.fromarray(np.full(shapes[kind], 90, np.uint8)).save(path)
    with pytest.raises(SystemExit) as status:
        main(["maps", "encode", *map(str, files)])
    assert status.value.code == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    assert not (tmp_path / "aniso.dds").exists()
