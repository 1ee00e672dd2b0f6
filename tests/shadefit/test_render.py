"""The renderer: its functions, light and scenes, the files that it writes, and bad settings."""

import io
import itertools
import json
import os
import struct
import time
import zlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from PIL import Image

import integrals
from coefficients.catalogue import entries
from coefficients.exported_code import exported_values
from coefficients.textures.exr import write_exr
from quantities.fuzz.g import G
from quantities.fuzz.ps import PS
from quantities.fuzz.q import Q
from quantities.fuzz.r import R
from shadefit import images
from shadefit.cli import main
from shadefit.commands.render import run
from shadefit.figures.values import round_up
from shadefit.images import read_image as real_read_image
from shadefit.outputs import RenderOutput
from shadefit.render import image, sheet
from shadefit.render.comparison import Comparison
from shadefit.render.fibers import azimuths
from shadefit.render.functions import CHOICES, EXACT, table_sets
from shadefit.render.image import render_image, render_images
from shadefit.render.scenes import SCENES, cloth_height
from shadefit.render.settings import Settings
from shadefit.render.shade import _ROOTS, BACKDROP, interpolated_g, sky_coefficients
from shadefit.render.srgb import from_srgb, parse_colour, to_srgb
from shading import irradiance, radiance

SIZE = 16
# Points inside the domains of the tables, at their ends, and outside, where clamps act.
ALPHAS, TILTS = (0.01, 0.15, 0.35, 1.0), (0.0, 0.05, 0.4, np.pi / 2)
POLAR_ANGLES, AZIMUTHS = (0.0, 0.7, 1.5, np.pi / 2), (0.0, 1.0, np.pi)
DENSITIES, COSINES = (0.0, 1e-4, 0.2, 0.5, 0.8), (1e-9, 1e-4, 0.01, 0.5, 1.0)


def combinations(*axes):
    return np.array(list(itertools.product(*axes)))


def at_rows(function, rows):
    """Evaluate a function of scalars at each row of an array."""
    return jax.jit(jax.vmap(lambda row: function(*row)))(rows)


def functions_of(name):
    (found,) = (each for each in table_sets() if each.name == name)
    return found


@pytest.mark.parametrize("name", CHOICES)
def test_rendered_tables_are_the_exported_code(name):
    functions = functions_of(name)
    ps, g, q, r = (CHOICES[name](owner) for owner in (PS, G, Q, R))
    points = combinations(ALPHAS, TILTS, POLAR_ANGLES, AZIMUTHS)
    _, cosines = ps.arguments_at(points)
    rows = np.column_stack([cosines, np.cos(points[:, 1]), points[:, :2]])
    close(at_rows(functions.ps, rows), exported_values(ps, points))
    points = combinations(DENSITIES, COSINES)
    close(at_rows(functions.g, points), exported_values(g, points))
    points = combinations(DENSITIES)
    close(at_rows(functions.q, points), exported_values(q, points))
    points = combinations(ALPHAS, TILTS)
    close(at_rows(functions.r, points), exported_values(r, points))


def close(rendered, exported):
    """Assert equality but for the rounding of float64, which compilation may change."""
    assert np.all(np.isfinite(exported))
    np.testing.assert_allclose(rendered, exported, rtol=1e-10, atol=1e-12)


def test_published_g_is_zero_without_a_layer():
    assert functions_of("published").g(0.0, 0.01) == 0


@pytest.mark.parametrize("owner", [PS, G, Q, R], ids=lambda owner: owner.name)
def test_the_best_table_has_the_least_rms_error(owner):
    def rms(entry):
        return entry.table.errors.off_grid.rms

    chosen = CHOICES["best"](owner)
    others = [entry for entry in entries(owner) if entry.kind == "best"]
    assert len(others) > 1
    assert chosen in others
    assert all(rms(chosen) <= rms(entry) for entry in others)


def cloth(x, y):
    return cloth_height(jnp.asarray(x), jnp.asarray(y))


def channels(names, height=3, width=5) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    return {name: rng.normal(size=(height, width)) * 10.0 ** rng.integers(-3, 5) for name in names}


def read_exr(data: bytes) -> dict[str, np.ndarray]:
    """Read a file of `write_exr`: scan lines of 32-bit floats without compression."""
    assert struct.unpack_from("<2i", data) == (20000630, 2)
    attributes, at = {}, 8
    while data[at]:
        key, kind, _ = data[at:].split(b"\0", 2)
        at += len(key) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        attributes[key] = data[at + 4 : at + 4 + size]
        at += 4 + size
    assert attributes[b"compression"] == b"\0"
    names, listed = [], attributes[b"channels"]
    while listed[0]:
        name, listed = listed.split(b"\0", 1)
        assert struct.unpack_from("<i", listed) == (2,)
        names.append(name.decode())
        listed = listed[16:]
    left, top, right, bottom = struct.unpack("<4i", attributes[b"dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    offsets = struct.unpack_from(f"<{height}Q", data, at + 1)
    count = width * len(names)
    rows = [np.frombuffer(data, "<f4", count, offset + 8) for offset in offsets]
    image = np.stack(rows).reshape(height, len(names), width)
    return {name: image[:, i] for i, name in enumerate(names)}


def test_an_exr_file_is_read_back_bit_for_bit():
    written = channels(["R", "G", "B", "sphere.exact.R"])
    read = read_exr(write_exr(written))
    assert list(read) == sorted(written)
    for name, values in written.items():
        np.testing.assert_array_equal(read[name], values.astype(np.float32))


def test_the_openexr_library_reads_the_file(tmp_path):
    library = pytest.importorskip("OpenEXR")
    written, path = channels(["R", "G", "B"]), tmp_path / "image.exr"
    path.write_bytes(write_exr(written))
    pixels = library.File(str(path)).channels()["RGB"].pixels
    expected = np.stack([written[name] for name in "RGB"], axis=-1).astype(np.float32)
    np.testing.assert_array_equal(pixels, expected)


def test_srgb_follows_the_standard_up_to_its_shoulder():
    np.testing.assert_allclose(
        to_srgb(np.array([0.0, 0.0031308, 0.2140411])), [0, 0.04045, 0.5], atol=1e-4
    )
    x = np.linspace(0, 0.8, 50)
    np.testing.assert_allclose(from_srgb(to_srgb(x)), x, atol=1e-7)
    assert np.all(np.diff(to_srgb(np.linspace(0, 5, 200))) > 0)
    assert to_srgb(np.array([1e9])) <= 1


def test_colours_are_read_or_refused():
    np.testing.assert_allclose(parse_colour("#ff0080", "fiber"), (1, 0, 0.2158605), atol=1e-6)
    for text in (
        "#ff00",
        "red",
        "#gg0000",
        "",
        "#1234567",
        "#-1-1-1",
        "# 1 1 1",
        "#1_1_1_",
        "#١٢٣٤٥٦",
    ):
        with pytest.raises(ValueError, match="fiber is"):
            parse_colour(text, "fiber")


def test_the_sky_has_its_three_colours():
    light = sky_coefficients()
    for height, expected in ((1.0, (0.55, 0.70, 1.0)), (0.0, (0.95, 0.92, 0.88))):
        at = np.array([np.sqrt(1 - height**2), 0.0, height])
        np.testing.assert_allclose(radiance(light, at), expected, rtol=1e-12)
    below = np.array([0.0, 0.0, -1.0])
    np.testing.assert_allclose(radiance(light, below), (0.22, 0.19, 0.17), rtol=1e-12)


@pytest.mark.slow
def test_interpolated_g_has_no_visible_error():
    roots = np.linspace(_ROOTS[0], 1, 3001)
    exact = jax.jit(jax.vmap(integrals.G.value, (None, 0)))
    for density in (0.01, 0.5):
        between = jax.vmap(interpolated_g, (None, 0))(exact(density, _ROOTS**2), roots**2)
        np.testing.assert_allclose(between, exact(density, roots**2), atol=1e-5)


@pytest.mark.parametrize("scene", ["sphere", pytest.param("cloth", marks=pytest.mark.slow)])
def test_visible_points_lie_on_the_surface(scene):
    hits = SCENES[scene].hits(SIZE)
    seen = np.asarray(hits.seen)
    p, n = np.asarray(hits.position)[seen], np.asarray(hits.normal)[seen]
    off = p[:, 2] - cloth(p[:, 0], p[:, 1]) if scene == "cloth" else (p**2).sum(1) - 1
    assert np.abs(off).max() < 1e-4
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1, rtol=1e-12)
    assert np.all((n * np.asarray(hits.view)[seen]).sum(1) > -0.05)
    np.testing.assert_allclose((n * np.asarray(hits.comb)[seen]).sum(1), 0, atol=1e-6)
    if scene == "cloth":
        step = 1e-5
        slope = (cloth(p[:, 0] + step, p[:, 1]) - cloth(p[:, 0] - step, p[:, 1])) / 2
        np.testing.assert_allclose(-n[:, 0] / n[:, 2], slope / step, atol=1e-6)
    assert np.all((hits.open_sky > 0) & (hits.open_sky <= 1))


@pytest.mark.parametrize("name", ["sphere", pytest.param("cloth", marks=pytest.mark.slow)])
def test_bands_of_rows_are_the_whole(name):
    scene = SCENES[name]
    whole = scene.hits(SIZE)
    bands = [scene.hits(SIZE, rows) for rows in ((0, 10), (10, SIZE))]
    for field, values in vars(whole).items():
        together = np.concatenate([getattr(band, field) for band in bands])
        # The rays to the cloth are float32, in which compilation may change the last bits.
        np.testing.assert_allclose(together, values, atol=1e-5)


@pytest.mark.slow
def test_the_large_image_is_the_average_of_its_samples(monkeypatch):
    settings = Settings(size=SIZE)
    monkeypatch.setattr(image, "_LARGE_BAND", 7 * SIZE * 4)
    monkeypatch.setattr(image, "LARGE", 10)
    monkeypatch.setattr(image, "LARGE_SAMPLES", 2)
    large = image.render_large(SCENES["sphere"], settings, EXACT)
    np.testing.assert_allclose(large, render_image(SCENES["sphere"], settings, EXACT), rtol=1e-9)


def test_bands_of_an_image_are_the_image(monkeypatch):
    settings, told = Settings(size=SIZE), []
    whole = render_image(SCENES["cloth"], settings, EXACT)
    # A band of 15 rows of pixels; the last has fewer.
    monkeypatch.setattr(image, "_BAND", 15 * SIZE * image.SAMPLES**2)
    wanted = [(settings, EXACT), (replace(settings, sun=0.0), EXACT)]
    found, dark = render_images(
        SCENES["cloth"], wanted, lambda done, total: told.append((done, total))
    )
    np.testing.assert_array_equal(found, whole)
    assert dark.mean() < found.mean()
    assert told == [(k, -(-SIZE // 15)) for k in range(-(-SIZE // 15))]


def test_the_sheet_shows_differences_fifty_times_as_large():
    noise = np.random.default_rng(3)
    exact, *others = 0.3 + 0.01 * noise.random((3, SIZE, SIZE, 3))
    compared = Comparison(SCENES["sphere"], exact, dict(zip(("one", "two"), others, strict=True)))
    figure = sheet._draw([compared], exact)
    shown = {axes.get_title(): axes for axes in figure.axes if axes.get_images()}
    assert list(shown)[:2] == ["sphere, exact", "(one − exact) × 50"]
    hero = figure.axes[0].get_window_extent()
    for name in ("one", "two"):
        axes = shown[f"({name} − exact) × 50"]
        (pixels,) = axes.get_images()
        np.testing.assert_allclose(pixels.get_array(), 50 * compared.difference(name))
        assert axes.get_window_extent().width < hero.width / 3


@pytest.mark.slow
def test_without_a_layer_the_sphere_is_lambertian():
    """At density 0 the radiance is base (E_sun max(u·n, 0) + E_sky)/π."""
    settings = Settings(density=0.0, size=SIZE, fibers="even")
    rendered = render_image(SCENES["sphere"], settings, EXACT)
    hits, light = SCENES["sphere"].hits(2 * SIZE), settings.light
    normal = np.asarray(hits.normal)
    sun = np.maximum(normal @ light.direction, 0)[:, None] * light.sun * np.array([1.0, 0.93, 0.82])
    sky = jax.vmap(irradiance, (None, 0))(sky_coefficients(), normal) * light.sky
    expected = np.array(settings.material.base) / np.pi * (sun + np.asarray(sky))
    expected = np.where(np.asarray(hits.seen)[:, None], expected, BACKDROP)
    expected = expected.reshape(SIZE, 2, SIZE, 2, 3).mean((1, 3))
    # The least cosine of the light changes only samples that the sun lights at a grazing angle.
    np.testing.assert_allclose(rendered, expected, atol=1e-6)


@pytest.mark.slow
def test_tables_are_hard_to_tell_from_exact_functions():
    settings = Settings(size=SIZE)
    exact = render_image(SCENES["sphere"], settings, EXACT)
    published, *others = table_sets()
    assert [each.name for each in (published, *others)] == ["published", "refitted", "best"]
    difference = np.abs(render_image(SCENES["sphere"], settings, published) - exact)
    assert 1e-5 < difference.max() < 0.05


def test_fibres_lean_as_a_map_says(tmp_path):
    path = tmp_path / "map.png"
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[..., 0], pixels[..., 1] = 128, 255
    Image.fromarray(pixels).save(path)
    hits = SCENES["sphere"].hits(SIZE)
    np.testing.assert_allclose(azimuths(str(path), hits), np.pi / 2, atol=0.005)
    assert np.all(azimuths("even", hits) == 0)
    crushed = np.asarray(azimuths("crushed", hits))
    assert np.ptp(crushed) > 1
    assert np.abs(crushed).max() < np.pi / 2


@pytest.mark.parametrize("content", [None, b"no image", b"grey"])
def test_a_file_that_is_no_map_is_refused(tmp_path, content):
    path = tmp_path / "map.png"
    if content == b"grey":
        buffer = io.BytesIO()
        Image.fromarray(np.zeros((4, 4), np.uint8)).save(buffer, "png")
        content = buffer.getvalue()
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ValueError, match="fibers"):
        azimuths(str(path), SCENES["sphere"].hits(SIZE))


def png_chunk(kind: bytes, data: bytes) -> bytes:
    """Return a chunk of a PNG file."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


# A name and compressed data, which is damaged, of another method, or unpacks to 64 MB.
PROFILES = [
    b"name\0\0damaged",
    b"name\0\1" + zlib.compress(b"profile"),
    b"name\0\0" + zlib.compress(bytes(1 << 26)),
    b"no end of the name",
    b"",
]


@pytest.mark.parametrize("profile", PROFILES)
def test_a_damaged_colour_profile_is_ignored_or_refused_in_one_line(tmp_path, profile):
    path = tmp_path / "map.png"
    Image.fromarray(np.full((4, 4, 3), 128, np.uint8)).save(path)
    data = path.read_bytes()
    for kind in (b"iCCP", b"zTXt", b"iTXt"):
        path.write_bytes(data[:33] + png_chunk(kind, profile) + data[33:])
        try:
            azimuths(str(path), SCENES["sphere"].hits(SIZE))
        except ValueError as error:
            assert str(error).startswith("fibers: ")
            assert "\n" not in str(error)


def test_a_pipe_or_a_device_is_no_map(tmp_path):
    os.mkfifo(tmp_path / "pipe.png")
    (tmp_path / "zero.png").symlink_to("/dev/zero")
    for name in ("pipe.png", "zero.png"):
        with pytest.raises(ValueError, match=rf"^fibers: .*{name}: it is no regular file"):
            azimuths(str(tmp_path / name), SCENES["sphere"].hits(SIZE))


def test_a_map_is_read_once_until_it_changes(tmp_path, monkeypatch):
    path, hits, read = tmp_path / "map.png", SCENES["sphere"].hits(SIZE), []
    monkeypatch.setattr(
        images, "read_image", lambda *given: read.append(given) or real_read_image(*given)
    )
    for turn, (red, green) in enumerate([(128, 255), (255, 128), (128, 0)], start=1):
        pixels = np.zeros((4, 4, 3), np.uint8)
        pixels[..., 0], pixels[..., 1] = red, green
        Image.fromarray(pixels).save(path)
        os.utime(path, ns=(turn, turn))
        first = azimuths(str(path), hits)
        np.testing.assert_array_equal(azimuths(str(path), hits), first)
        assert len(read) == turn
        angle = np.arctan2(green / 127.5 - 1, red / 127.5 - 1)
        np.testing.assert_allclose(first, angle, atol=1e-6)


def test_a_map_is_read_once_by_two_threads(tmp_path, monkeypatch):
    path, hits, read = tmp_path / "map.png", SCENES["sphere"].hits(SIZE), []
    Image.fromarray(np.full((4, 4, 3), 200, np.uint8)).save(path)

    def slow(*arguments):
        read.append(path)
        time.sleep(0.05)
        return real_read_image(*arguments)

    monkeypatch.setattr(images, "read_image", slow)
    with ThreadPoolExecutor(2) as workers:
        list(workers.map(lambda _: azimuths(str(path), hits), range(2)))
    assert len(read) == 1


@pytest.mark.parametrize("size", [(4097, 1), (1, 4097), (15000, 15000), (2**31 - 1, 2**31 - 1)])
def test_a_map_of_too_many_pixels_is_refused_before_they_are_read(tmp_path, size):
    header = png_chunk(b"IHDR", struct.pack(">IIBBBBB", *size, 8, 2, 0, 0, 0))
    path = tmp_path / "map.png"
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + header + png_chunk(b"IDAT", b"") + png_chunk(b"IEND", b"")
    )
    with pytest.raises(ValueError, match=f"{size[0]}×{size[1]} pixels: allowed are 4096 an edge"):
        azimuths(str(path), SCENES["sphere"].hits(SIZE))


@pytest.mark.parametrize(
    "change",
    [
        {"density": 0.6},
        {"density": float("nan")},
        {"spread": 0.0},
        {"tilt": 2.0},
        {"size": 8},
        {"fiber": "pink"},
        {"sun": -1.0},
    ],
)
def test_bad_settings_are_refused_by_name(tmp_path, change):
    (name,) = change
    with pytest.raises(ValueError, match=name):
        run([], Settings(**change), tmp_path / "out", sweep=False, json=False)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_the_command_writes_both_files(tmp_path, capsys):
    arguments = ["render", "sphere", "--size", str(SIZE), "--out", str(tmp_path), "--json"]
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 0
    record = json.loads(capsys.readouterr().out)
    RenderOutput.model_validate(record)
    assert {row["tables"] for row in record["images"]} == {each.name for each in table_sets()}
    assert (tmp_path / "render.png").read_bytes().startswith(b"\x89PNG")
    read = read_exr((tmp_path / "render.exr").read_bytes())
    np.testing.assert_array_equal(read["R"], read["sphere.exact.R"])
    for row in record["images"]:
        weights = dict(R=0.2126, G=0.7152, B=0.0722)
        difference = sum(
            w * (read[f"sphere.{row['tables']}.{c}"] - read[f"sphere.exact.{c}"])
            for c, w in weights.items()
        )
        np.testing.assert_allclose(np.abs(difference).max(), row["max"], rtol=1e-3, atol=1e-6)


@pytest.mark.slow
def test_the_sweep_is_drawn(tmp_path):
    run(["sphere"], Settings(size=SIZE), tmp_path, sweep=True, json=False)
    with Image.open(tmp_path / "sweep.png") as sheet:
        assert sheet.size[0] > 400


def test_limits_are_round():
    assert [round_up(x) for x in (0.0011, 0.002, 0.3, 7.0)] == [0.002, 0.002, 0.5, 10.0]
    assert round_up(0.0012, (1.0, 1.5, 10.0)) == 0.0015
