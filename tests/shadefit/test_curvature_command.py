"""`shadefit curvature`, mesh files and smoothing: what is written, and bad input in one line."""

import json
import re
import struct

import numpy as np
import pytest
from PIL import Image

from shadefit.cli import main
from shadefit.curvature import curvature
from shadefit.curvature.files import ply_bytes, read_mesh
from shadefit.curvature.generators import icosphere, torus
from shadefit.curvature.smoothing import convex, smoothed
from shadefit.curvature.vertex_bytes import from_bytes, to_bytes
from tests.shadefit.test_records import CHECKED

pytest.importorskip("trimesh")


def run(*arguments) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["curvature", *map(str, arguments)])
    return ended.value.code


@pytest.fixture
def sphere(tmp_path):
    made = icosphere(10.0, 2)
    path = tmp_path / "sphere.ply"
    path.write_bytes(ply_bytes(made, curvature(made)))
    return path


def test_a_sphere_is_read_with_its_normals_and_written(sphere, tmp_path, capsys):
    out = tmp_path / "out.ply"
    assert run(sphere, "--unit", "cm", "-o", out, "--json") == 0
    said = CHECKED.validate_json(capsys.readouterr().out)
    assert (said.vertices, said.triangles, said.made_normals) == (162, 320, 0)
    np.testing.assert_allclose(said.mean_curvature, 0.01, rtol=1e-6)
    again = read_mesh(out, "mm")
    np.testing.assert_allclose(np.linalg.norm(again.vertices, axis=1), 100.0, rtol=1e-6)
    assert run(sphere, "--unit", "mm") == 0
    assert "0.1000" in capsys.readouterr().out


def test_smoothing_keeps_a_sphere_and_clamping_removes_concavity():
    made = icosphere(20.0, 3)
    found = curvature(made)
    assert np.abs(smoothed(made, found).tensors - found.tensors).max() < 1e-14
    ring = torus(15.0, 6.0, 24, 12)
    raw = curvature(ring)
    least = np.linalg.eigvalsh(convex(raw).tensors[:, [[0, 1], [1, 2]]]).min()
    assert least > -1e-15 > np.linalg.eigvalsh(raw.tensors[:, [[0, 1], [1, 2]]]).min()
    with pytest.raises(ValueError, match="widths = "):
        smoothed(made, found, [0.0])


def test_drift_is_written_after_the_tensor(sphere, tmp_path, capsys):
    out = tmp_path / "out.ply"
    assert run(sphere, "--unit", "mm", "-o", out, "--drift", "1.4", "--json") == 0
    assert CHECKED.validate_json(capsys.readouterr().out).drift == 1.4
    header, _, body = out.read_bytes().partition(b"end_header\n")
    names = [line.split()[2] for line in header.splitlines() if line.startswith(b"property f")]
    assert names[-2:] == [b"drift_t", b"drift_b"]
    values = np.frombuffer(body[:60], "<f4", 14)
    assert np.abs(values[12:]).max() < 1e-6


@pytest.mark.slow
def test_a_mesh_is_drawn_the_same_twice_and_nothing_is_left_of_a_mesh_without_extent(
    sphere, tmp_path, capsys
):
    options = ["--unit", "mm", "--size", "64", "--widths", "1.4", "--view", "30,-20"]
    pictures = [tmp_path / f"{k}.png" for k in range(2)]
    for each in pictures:
        assert run(sphere, *options, "--picture", each) == 0
    first, second = (Image.open(each) for each in pictures)
    assert first.size == second.size
    assert np.array_equal(np.asarray(first), np.asarray(second))
    # There is skin, which is redder than all texts and white.
    colours = np.asarray(first).astype(int)
    assert np.mean(colours[..., 0] > colours[..., 2] + 40) > 0.02
    edge_on = tmp_path / "edge-on.obj"
    edge_on.write_text("v 0 0 0\nv 0 0 9\nv 5 0 0\nf 1 2 3\n")
    assert run(edge_on, *options[:4], "--picture", tmp_path / "edge-on.png") == 0
    point = tmp_path / "point.obj"
    point.write_text("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n")
    capsys.readouterr()
    assert (
        run(point, "--unit", "mm", "--picture", tmp_path / "point.png", "-o", tmp_path / "p.ply")
        == 2
    )
    assert "the mesh is a point in this view" in capsys.readouterr().err
    assert not (tmp_path / "point.png").exists() and not (tmp_path / "p.ply").exists()


def test_bytes_keep_half_a_step():
    tensors = np.random.default_rng(1).uniform(-0.5, 0.5, (100, 3))
    back = from_bytes(to_bytes(tensors))
    assert np.abs(back[:, :3] - tensors).max() <= 0.5 / 127 / 2 * (1 + 1e-12)
    with pytest.raises(ValueError, match="range = 0: allowed"):
        to_bytes(tensors, 0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("f 1 2 3", "f 0 1 2"), "a face has vertex 0: allowed are numbers from 1, or below 0"),
        (("f 1 2 3", "f 1 2 0/1"), "a face has vertex 0"),
        (("v 1 0 0", "v 1e400 0 0"), "vertex 1 is [inf, nan, nan]"),
    ],
)
def test_an_obj_file_that_would_be_misread_is_refused_in_one_line(
    tmp_path, capsys, recwarn, change, message
):
    path = tmp_path / "mesh.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1 2 3\n".replace(*change))
    assert run(path, "--unit", "mm") == 2
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == 1
    assert not recwarn.list


def test_a_gltf_file_may_not_refer_to_other_folders(tmp_path, capsys):
    (tmp_path / "secret.bin").write_bytes(bytes(36))
    inner = tmp_path / "inner"
    inner.mkdir()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "../secret.bin", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    path = inner / "mesh.gltf"
    path.write_text(json.dumps(document))
    assert run(path, "--unit", "mm") == 2
    assert "allowed are files beside it" in capsys.readouterr().err


def glb(document: dict, data: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<2I", len(data), 0x004E4942) + data
    return b"glTF" + struct.pack("<2I", 2, 12 + len(chunks)) + chunks


@pytest.mark.parametrize(
    ("accessor", "parts", "said"),
    [
        ({"count": 10**9}, 1, "its parts have 1.2e+10 bytes, but its data only"),
        ({"count": 10**9, "bufferView": 0}, 1, "its parts have 1.2e+10 bytes"),
        ({"count": 100_000}, 200, "its parts have 2.4e+08 bytes"),
        ({"count": 3, "bufferView": 0}, 1, ""),
    ],
)
def test_a_glb_file_that_would_fill_the_memory_is_refused(tmp_path, accessor, parts, said):
    data = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"componentType": 5126, "type": "VEC3", **accessor}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}] * parts}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    path = tmp_path / "mesh.glb"
    path.write_bytes(glb(document, data))
    if said:
        with pytest.raises(ValueError, match=re.escape(said)) as error:
            read_mesh(path, "mm")
        assert "\n" not in str(error.value)
    else:
        assert len(read_mesh(path, "mm").triangles) == 1


@pytest.mark.parametrize(
    ("name", "content", "options", "message"),
    [
        ("a.ply", None, [], "the unit of the mesh is not known"),
        ("a.ply", None, ["--unit", "mile"], "unit 'mile' is not known"),
        ("a.ply", None, ["--unit", "mm"], "No such file"),
        ("a.stl", "x", ["--unit", "mm"], "allowed are files that end with"),
        ("a.ply", "garbage", ["--unit", "mm"], "cannot be read as a mesh"),
        ("a.glb", "garbage", ["--unit", "mm"], "cannot be read as a mesh"),
        ("a.obj", "v 0 0 0\n", ["--unit", "mm"], "a.obj"),
        ("a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ["--unit", "mm"], "vertex 0 is"),
        ("a.ply", None, ["--unit", "mm", "--widths", "-1"], "--widths -1: allowed"),
        ("a.ply", None, ["--unit", "mm", "--range", "0"], "range = 0: allowed"),
        ("a.ply", None, ["--unit", "mm", "-o", "b.obj"], "allowed is a file that ends with .ply"),
        (
            "a.ply",
            None,
            ["--unit", "mm", "--picture", "b.jpg"],
            "allowed is a file that ends with .png",
        ),
        ("a.ply", None, ["--unit", "mm", "--drift", "0"], "--drift 0: allowed are 0.001"),
        ("a.ply", None, ["--unit", "mm", "--size", "9"], "--size 9: allowed are 32 to 1024"),
        ("a.ply", None, ["--unit", "mm", "--view", "1"], "--view 1: allowed are an azimuth"),
        ("a.ply", None, ["--unit", "mm", "--light", "0,91"], "--light 0,91: allowed are"),
        ("a.ply", None, ["--unit", "mm", "--light", "nan,0"], "--light nan,0: allowed are"),
    ],
)
def test_bad_input_is_one_line(tmp_path, capsys, name, content, options, message):
    path = tmp_path / name
    if content is not None:
        path.write_text(content)
    assert run(path, *options) == 2
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == 1
