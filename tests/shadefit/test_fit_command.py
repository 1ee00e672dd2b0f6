"""shadefit fit and shadefit new: forms for a file of data, and a first problem file."""

import json

import numpy as np
import pytest

from quantities.registry import unregister
from shadefit.cli import main


@pytest.fixture
def run(capsys):
    def run(*arguments, status: int = 0) -> str:
        with pytest.raises(SystemExit) as ended:
            main([str(each) for each in arguments])
        output = capsys.readouterr()
        assert ended.value.code == status, output.err
        return output.err if status else output.out

    return run


@pytest.fixture
def data(tmp_path):
    x = np.linspace(0.0, 2.0, 150)
    rows = [f"{each:.17g},{(1 + each) / (1 + 3 * each):.17g}" for each in x]
    path = tmp_path / "data.csv"
    path.write_text("\n".join(["NdotV,E", *rows]) + "\n")
    return path


def test_forms_are_fitted_to_the_rows_of_a_file(run, data, tmp_path):
    out = tmp_path / "tables"
    given = ["fit", data, "--x", "NdotV", "--y", "E", "--out", out]
    both = ["--form", "rational:1,1", "--form", "polynomial:2"]
    tables = [each["content"] for each in json.loads(run(*given, *both, "--json"))["tables"]]
    assert [each["form"] for each in tables] == ["rational-1-1", "polynomial-2"]
    exact, rough = tables
    assert exact["coefficients"] == pytest.approx([1, 1, 3], rel=1e-7)
    assert exact["errors"]["off_grid"]["max"] < 1e-9 < rough["errors"]["off_grid"]["max"]
    reference = exact["reference"]
    assert reference["leg"] == "data"
    assert (reference["data"]["rows"], reference["data"]["held_out"]) == (150, 30)
    assert exact["uncertainty"]["unique"]
    assert exact["provenance"]["command"].startswith("shadefit fit ")
    # The table needs neither the data nor the command.
    code = run("export", out / "e-rational-1-1.json", "--to", "hlsl")
    assert "float E(float NdotV)" in code
    assert "30 rows" not in code
    assert "not measured again" in code
    assert "against the integral" not in code


def test_the_result_is_shown_as_a_table(run, data):
    shown = run("fit", data, "--x", "NdotV", "--y", "E", "--form", "rational:1,1")
    for text in ("rms error", "against the data's own points", "±", "denominators"):
        assert text in shown


@pytest.mark.parametrize("form", ["chebyshev:2", "exponentials:1", "poles:1,0", "piecewise:4"])
def test_every_shape_has_a_name_on_the_command_line(run, data, form):
    given = ["fit", data, "--x", "NdotV", "--y", "E", "--form", form, "--hold-out", 0, "--json"]
    (table,) = json.loads(run(*given))["tables"]
    assert table["form"] == form.replace(":", "-").replace(",", "-")
    assert table["errors"]["max"] < 0.25


@pytest.mark.parametrize("form", ["exponentials:2,1", "piecewise:4,3", "piecewise:3"])
def test_shapes_of_two_axes_have_a_name_on_the_command_line(run, tmp_path, form):
    x, y = np.meshgrid(np.linspace(0, 2, 12), np.linspace(0, 1, 9))
    rows = np.stack([x.ravel(), y.ravel(), ((1 + y) * np.exp(-x)).ravel()], axis=1)
    np.savetxt(tmp_path / "grid.csv", rows, delimiter=",", header="x,y,f", comments="")
    given = ["--x", "x,y", "--y", "f", "--form", form, "--hold-out", 0, "--json"]
    (table,) = json.loads(run("fit", tmp_path / "grid.csv", *given))["tables"]
    assert table["errors"]["max"] < 0.1


def test_of_few_rows_none_is_held_out(run, tmp_path):
    path = tmp_path / "few.csv"
    path.write_text("x,y\n0,1\n1,3\n2,5\n3,7\n")
    (table,) = json.loads(
        run("fit", path, "--x", "x", "--y", "y", "--form", "polynomial:1", "--json")
    )["tables"]
    assert table["content"]["reference"]["data"]["held_out"] == 0
    assert table["content"]["coefficients"] == pytest.approx([1, 2])


BAD = {
    "a shape": (["--form", "spline:3"], "--form 'spline:3': allowed are rational, polynomial"),
    "no numbers": (["--form", "rational"], "--form 'rational': '' are no whole numbers"),
    "a third number": (["--form", "rational:1,2,3"], "allowed are 2 numbers after rational:"),
    "a negative number": (["--form", "polynomial:-1"], "--form 'polynomial:-1': allowed"),
    "a column": (["--x", "alpha", "--form", "polynomial:1"], "has no column 'alpha': allowed are"),
    "rows": (["--hold-out", "1", "--form", "polynomial:1"], "hold_out = 1: allowed are 0 and 2"),
    "too rich": (["--form", "polynomial:200"], "has 201 coefficients, but data.csv has only 120"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line(run, data, case):
    options, message = BAD[case]
    told = run("fit", data, "--x", "NdotV", "--y", "E", *options, status=2)
    assert message in told
    assert told.count("\n") == 1


def test_a_new_problem_file_works_as_it_is(run, tmp_path):
    path = run("new", "my-lobe", "--axes", "eta=1:3", "--axes", "k=0.5:2", "--out", tmp_path)
    assert path.strip() == str(tmp_path / "my_lobe.py")
    file = ["-p", tmp_path / "my_lobe.py"]
    try:
        told = json.loads(run("evaluate", *file, "my-lobe", "--eta", 2, "--k", 1, "--json"))
        assert told["legs"]["quadrature"]["value"] == pytest.approx((1 - np.exp(-3)) / 3, rel=1e-12)
        made = json.loads(run("refit", *file, "--out", tmp_path, "--json"))["tables"]
        assert [each["form"] for each in made] == ["short"]
    finally:
        unregister("my-lobe")


def test_a_new_problem_file_replaces_none(run, tmp_path):
    (tmp_path / "lobe.py").write_text("mine")
    told = run("new", "lobe", "--out", tmp_path, status=2)
    assert "exists already: it is not replaced" in told
    assert (tmp_path / "lobe.py").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["1x"], "'1x' is no name"),
        (["lobe", "--axes", "eta"], "--axes eta: allowed is NAME=LOW:HIGH"),
        (["lobe", "--axes", "eta=3:1"], "allowed are finite numbers, the first one less"),
        (["lobe", "--axes", "eta=a:b"], "a and b have to be numbers"),
        (["lobe", "--axes", "lambda=0:1"], "lambda is taken"),
        (["lobe", "--axes", "c0=0:1"], "c0 is taken"),
        (["lobe", "--axes", "e=0:1", "--axes", "e=0:1"], "e is there twice"),
        (["lobe", "--axes", '__import__("os")=0:1'], "allowed is NAME=LOW:HIGH"),
    ],
)
def test_a_wrong_new_file_is_refused(run, tmp_path, arguments, message):
    assert message in run("new", *arguments, "--out", tmp_path, status=2)
    assert not list(tmp_path.iterdir())


def test_a_table_of_data_is_verified_without_the_data(run, data, tmp_path):
    given = ["fit", data, "--x", "NdotV", "--y", "E", "--form", "rational:1,1", "--out", tmp_path]
    run(*given)
    told = json.loads(run("verify", tmp_path / "e.json", "--to", "python", "--json"))
    (check,) = told["tables"][0]["checks"]
    assert check["status"] == "passed"
    assert check["form"]["max"] < 1e-6
    assert check["integral"] is None
    assert "—" in run("verify", tmp_path / "e.json", "--to", "python")
