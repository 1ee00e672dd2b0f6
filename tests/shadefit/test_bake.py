"""`shadefit bake` and `shadefit evaluate --points`: what they write, say and refuse."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from coefficients.catalogue import FOLDER, load, resolve
from integrals import Q
from quantities import loader, registry
from shadefit.cli import main

SOFT = Path(__file__).parents[2] / "examples" / "soft_step.py"


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as stopped:
        main([str(each) for each in arguments])
    captured = capsys.readouterr()
    return stopped.value.code, captured.out, captured.err


def refuses(capsys, folder, *arguments):
    before = sorted(folder.iterdir())
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, ""), (arguments, out, err)
    assert err.startswith("shadefit: ")
    assert err.count("\n") == 1
    assert sorted(folder.iterdir()) == before
    return err


@pytest.fixture
def soft():
    yield
    registry.unregister("soft")
    loader._LOADED.clear()


# bake


def test_exact_values_are_baked_and_compared_with_the_tables(capsys, tmp_path):
    path = tmp_path / "q.npy"
    status, out, _ = run(capsys, "bake", "q", "--size", 33, "--format", "npy", "-o", path, "--json")
    assert status == 0
    report = json.loads(out)
    texels = np.load(path)
    # By default the domain is that of the published table.
    (axis,) = report["axes"]
    assert axis["coordinate"] == f"{32 / 33 * 2**0.5:.9g} sqrt(density) + {0.5 / 33:.9g}"
    assert (axis["name"], axis["domain"], axis["scale"]) == ("density", [0, 0.5], "square")
    density = 0.5 * np.linspace(0, 1, 33) ** 2
    np.testing.assert_allclose(texels, Q.values(density[:, None]), rtol=1e-7)
    assert (report["file"], report["bytes"], report["fetches"]) == (str(path), 4 * 33, 1)
    assert (report["size"], report["texel"], report["centres"]) == ([33], "float32", "ends")
    assert 0 < report["errors"]["rms"] < report["errors"]["max"] < 1e-3
    tables = {each["table"]: each for each in report["tables"]}
    assert {"q", "published/q", "best/q-4", "best/q-12-log"} <= set(tables)
    stated = resolve("best/q-9").require_table().errors
    assert stated is not None
    assert tables["best/q-9"]["max"] == stated.off_grid.max
    assert tables["best/q-9"]["operations"] == 10
    assert tables["best/q-9"]["domain"] == {}
    counts = [each["operations"] for each in report["tables"]]
    assert counts == sorted(counts)


def test_exact_and_the_quantity_are_the_same_and_bytes_are_repeated(capsys, tmp_path):
    files = [tmp_path / name for name in ("a.ktx2", "b.ktx2")]
    for source, path in zip(("q", "exact/q"), files, strict=True):
        assert run(capsys, "bake", source, "--size", 16, "--format", "ktx2", "-o", path)[0] == 0
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_table_is_baked_with_both_errors(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, _ = run(
        capsys, "bake", "best/q-4", "--size", 65, "--format", "png16", "--filter", "cubic", "--json"
    )
    assert status == 0
    report = json.loads(out)
    assert report["file"] == "best-q-4.png"
    texels = np.asarray(Image.open(tmp_path / "best-q-4.png"))[0] / 65535
    low, high = report["span"]
    fitted = load("best/q-4")
    # A border of one texel at each end.
    density = 0.5 * np.linspace(0, 1, 63) ** 2
    expected = [float(fitted(d)) for d in density]
    np.testing.assert_allclose(low + (high - low) * texels[1:-1], expected, atol=1e-5)
    assert report["table"]["max"] == pytest.approx(7.0e-4, rel=0.01)
    assert report["errors"]["max"] == pytest.approx(report["table"]["max"], rel=0.05)
    assert report["table"]["largest_difference"] < 2e-5


def test_the_text_says_what_a_shader_must_know(capsys, tmp_path):
    path = tmp_path / "q.dds"
    status, out, _ = run(
        capsys, "bake", "q", "--size", 32, "--format", "dds", "-o", path,
        "--range", "density=0:2:linear",
    )  # fmt: skip
    assert status == 0
    assert path.read_bytes()[:4] == b"DDS "
    assert "LUT 32, float16, linear" in out
    assert "density in [0, 2] (linear); centres: ends" in out
    assert "Texture coordinates: u = 0.484375 density + 0.015625." in out
    assert "q, refitted" in out
    # The tables are made for a part of this domain.
    assert out.count("density in [0, 0.5]") >= 6
    assert "No table of this domain is as accurate." in out


def test_a_quantity_of_a_file_is_baked(capsys, tmp_path, soft):
    path = tmp_path / "soft.exr"
    status, out, _ = run(
        capsys, "bake", "-p", SOFT, "soft", "--size", "16x8", "--format", "exr", "-o", path,
        "--centres", "half", "--json",
    )  # fmt: skip
    assert status == 0
    report = json.loads(out)
    assert (report["size"], report["texel"], report["tables"]) == ([16, 8], "float16", [])
    x, y = (np.arange(16) + 0.5) / 4, 0.5 + (np.arange(8) + 0.5) / 16
    data = path.read_bytes()
    lines = [data[len(data) - (8 - k) * 40 :][8:40] for k in range(8)]
    found = np.stack([np.frombuffer(line, "<f2") for line in lines])
    np.testing.assert_allclose(found, np.tanh(x[None] * y[:, None]), atol=3e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["q", "--size", "4x", "--format", "npy"], "size '4x': allowed are numbers of texels"),
        (["q", "--size", "4x4", "--format", "npy"], "size 4x4: expected are 1 numbers"),
        (["q", "--size", "1", "--format", "npy"], "size 1: allowed are 2 or more"),
        (["ps", "--size", "4x4x4x4", "--format", "npy"], "4 arguments: a texture has at most 3"),
        (["q", "--size", "4", "--format", "tga"], "'tga' is not one of"),
        (["q", "--size", "4", "--format", "png16", "--texel", "float16"], "png16 cannot hold"),
        (["nothing", "--size", "4", "--format", "npy"], "no table is called 'nothing'"),
        (["exact/nothing", "--size", "4", "--format", "npy"], "no closed form is exported as"),
        (["q", "--size", "4", "--format", "npy", "--range", "nu=0:1"], "'nu' is no axis: allowed"),
        (["q", "--size", "4", "--format", "npy", "--range", "density=0"], "allowed is NAME=LOW:"),
        (["q", "--size", "4", "--format", "npy", "--range", "density=a:1"], "allowed are two num"),
        (["q", "--size", "4", "--format", "npy", "--range", "density=-1:1"], "allowed is part of"),
        (["best/q-4", "--size", "4", "--format", "npy", "--range", "density=0:9"], "part of [0,"),
        (
            ["q", "--size", "4", "--format", "npy", "--range", "density=0:1:logarithmic"],
            "a logarithmic axis begins above 0",
        ),
    ],
)
def test_bad_options_write_nothing(capsys, tmp_path, arguments, message):
    err = refuses(capsys, tmp_path, "bake", *arguments, "-o", tmp_path / "lut")
    assert message in err


def test_a_file_that_cannot_be_written_is_refused_before_work(capsys, tmp_path):
    (tmp_path / "folder").mkdir()
    err = refuses(
        capsys, tmp_path, "bake", "q", "--size", 4, "--format", "npy", "-o", tmp_path / "folder"
    )
    assert "is a folder" in err


# evaluate --points

POINTS = np.array([[0.5, 0.3], [0.05, 1.2], [1.0, 0.0]])


@pytest.fixture
def csv_file(tmp_path) -> Path:
    path = tmp_path / "points.csv"
    lines = ["theta_f,note,alpha", *(f"{theta!r},x,{alpha!r}" for alpha, theta in POINTS.tolist())]
    path.write_text("\n".join(lines) + "\n\n", encoding="utf-8-sig")
    return path


def test_many_points_are_evaluated_to_csv(capsys, csv_file):
    status, out, _ = run(capsys, "evaluate", "r", "--points", csv_file)
    assert status == 0
    first, *lines = out.splitlines()
    best = "best/r-25,best/r-36,best/r-40-wide,best/r-45"
    assert first == f"alpha,theta_f,exact,error,published,refitted,{best}"
    rows = np.array([line.split(",") for line in lines], float)
    np.testing.assert_array_equal(rows[:, :2], POINTS)
    # R is ½ at α = 1.
    assert rows[2, 2] == pytest.approx(0.5, abs=1e-8)
    assert (rows[:, 3] < 1e-6).all()
    # Only one table is made for α = 0.05.
    assert np.isnan(rows[:, 4]).tolist() == [False, True, False]
    wide = load("best/r-40-wide")
    np.testing.assert_allclose(rows[:, 8], [float(wide(*point)) for point in POINTS], rtol=1e-12)
    # The largest error of this table.
    np.testing.assert_allclose(rows[:, 2], rows[:, 8], atol=7.4e-5)


def test_many_points_are_evaluated_to_files(capsys, tmp_path, csv_file):
    array = tmp_path / "points.npy"
    np.save(array, POINTS)
    out = {kind: tmp_path / f"values.{kind}" for kind in ("npy", "csv")}
    for given, path in ((array, out["npy"]), (csv_file, out["csv"])):
        status, said, _ = run(capsys, "evaluate", "r", "--points", given, "--out", path)
        assert (status, said) == (0, f"{path}\n")
    values = np.load(out["npy"], allow_pickle=False)
    names = ("alpha", "theta_f", "exact", "error", "published", "refitted")
    assert values.dtype.names[:6] == names
    read = np.genfromtxt(out["csv"], delimiter=",", names=True)
    for name in names:
        np.testing.assert_array_equal(values[name], read[name])


def test_many_points_are_printed_as_json(capsys, tmp_path):
    path = tmp_path / "points.npy"
    np.save(path, np.array([0.0, 0.25, 3.0]))
    status, out, _ = run(capsys, "evaluate", "q", "--points", path, "--json")
    assert status == 0
    found = json.loads(out)
    assert (found["quantity"], found["points"], found["file"]) == ("q", 3, None)
    np.testing.assert_allclose(
        found["values"]["exact"], Q.values(np.array([[0.0], [0.25], [3.0]])), rtol=1e-14
    )
    assert found["columns"] == list(found["values"])
    assert found["values"]["published"][2] is None


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("p.csv", b"", "has no column density: its first line must name density, cos_v"),
        ("p.csv", b"density\n1\n", "has no column cos_v"),
        ("p.csv", b"density,cos_v,cos-v\n1,1,1\n", "has several columns cos_v"),
        ("p.csv", b"density,cos_v\n", "has 0 points: allowed are 1 to"),
        ("p.csv", b"density,cos_v\n1\n", "line 2 has 1 cells: expected are 2"),
        ("p.csv", b"density,cos_v\n1,1\n1,x\n", "line 3: 'x' is no finite number"),
        ("p.csv", b"density,cos_v\n1,nan\n", "line 2: 'nan' is no finite number"),
        ("p.csv", b"density,cos_v\n1,1\n\n1,2\n", "line 3 has 0 cells"),
        ("p.csv", b"density,cos_v\n1,1\n1,2\n", "line 3: cos_v = 2 is outside its domain [0, 1]"),
        ("p.csv", b"\xff\xfe\x00", "is no CSV file"),
        ("p.csv", b'density,cos_v\n"1,1\n', "is no CSV file"),
        ("p.csv", b"density,cos_v\n1," + 200_000 * b"1", "is no CSV file: field larger than"),
        ("p.npy", b"", "is no NPY file"),
        ("p.npy", b"\x93NUMPY\x01\x00\x10\x00{'descr': 1}    ", "is no NPY file"),
        ("p.txt", b"", "allowed are files that end in .csv or .npy"),
        ("p.csv", None, "cannot be read: No such file"),
    ],
)
def test_bad_points_are_refused(capsys, tmp_path, name, content, message):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    assert message in refuses(capsys, tmp_path, "evaluate", "g", "--points", path)


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((3, 3)), "has an array (3, 3): expected is (points, 2), for density, cos_v"),
        (np.zeros(4), "has an array (4,)"),
        (np.array([["a", "b"]]), "has no array of numbers"),
        (np.zeros((1, 2), complex), "has no array of numbers"),
        (np.array([[1.0, 0.5], [1.0, np.nan]]), "row 1: cos_v = nan is outside its domain"),
        (np.array([{}], dtype=object), "is no NPY file: Object arrays cannot be loaded"),
    ],
)
def test_bad_arrays_are_refused(capsys, tmp_path, array, message):
    path = tmp_path / "points.npy"
    np.save(path, array)
    assert message in refuses(capsys, tmp_path, "evaluate", "g", "--points", path)


def test_options_that_do_not_go_together_are_refused(capsys, tmp_path, csv_file):
    both = ["evaluate", "r", "--alpha", "0.5", "--points", csv_file]
    assert "either arguments or --points" in refuses(capsys, tmp_path, *both)
    alone = ["evaluate", "q", "--density", "0.5", "--out", tmp_path / "a.csv"]
    assert "--out: allowed only with --points" in refuses(capsys, tmp_path, *alone)
    odd = ["evaluate", "r", "--points", csv_file, "--out", tmp_path / "a.txt"]
    assert "allowed are files that end in .csv or .npy" in refuses(capsys, tmp_path, *odd)
    foreign = ["evaluate", "r", "--points", csv_file, "--table", "best/q-4"]
    assert "is of q: allowed are those of r" in refuses(capsys, tmp_path, *foreign)


def test_a_refitted_table_is_baked_by_its_file(capsys, tmp_path):
    path = tmp_path / "lut.csv"
    table = FOLDER / "fuzz" / "refit" / "q.json"
    status, out, _ = run(
        capsys, "bake", table, "--size", 5, "--format", "csv", "-o", path, "--json"
    )
    assert status == 0
    assert json.loads(out)["table"]["operations"] == 6
    first, *lines = path.read_text().splitlines()
    assert first == "density,value"
    rows = np.array([line.split(",") for line in lines], float)
    fitted = load("q")
    np.testing.assert_allclose(rows[:, 1], [float(fitted(d)) for d in rows[:, 0]], rtol=1e-6)
