"""The commands about exported code: `export --to`, `verify` and `cost`."""

import functools
import json

import pytest

from coefficients import exported_code
from programs import PRECISIONS, ToolchainError, toolchain
from programs.toolchains import verification
from programs.toolchains.interface import Toolchain
from programs.toolchains.verification import Check
from shadefit.cli import main
from shadefit.commands.verify import ADVICE


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    captured = capsys.readouterr()
    return stopped.value.code, captured.out, captured.err


def test_verify_prints_a_row_a_language(capsys):
    status, out, _ = run(capsys, "verify", "q", "--to", "python", "--precision", "all", "--json")
    assert status == 0
    rows = json.loads(out)["tables"][0]["checks"]
    assert [row["precision"] for row in rows] == list(PRECISIONS)
    assert all(row["status"] == "passed" and row["form"]["points"] >= 100_000 for row in rows)
    status, out, _ = run(capsys, "verify", "q", "--to", "javascript")
    assert status == 0
    if toolchain("javascript").missing("double") is None:
        assert "passed" in out and "Node" in out


def test_a_missing_compiler_is_not_checked_and_never_passed(capsys, monkeypatch):
    monkeypatch.setattr(Toolchain, "missing", lambda self, precision: "gcc is not on PATH")
    status, out, _ = run(capsys, "verify", "q", "--to", "c")
    assert status == 0
    assert "not checked" in out and "passed" not in out
    # One line says how to get what is missing.
    advice = [line for line in out.splitlines() if "make toolchains" in line]
    assert advice == [f"1 of 1 not checked: {ADVICE}"]


def test_a_coefficient_that_is_no_half_is_no_missing_compiler(capsys, monkeypatch):
    found = Check("c", "half", "not checked", "c0 = 1e+06 is no half")
    monkeypatch.setattr("programs.check", lambda trial, key: found)
    monkeypatch.setattr(Toolchain, "missing", lambda self, precision: None)
    _, out, _ = run(capsys, "verify", "q", "--to", "c", "--precision", "half")
    assert "1e+06 is no half" in out and out.splitlines()[-1] == "1 of 1 not checked"


def test_verify_says_by_its_status_that_something_failed(capsys, monkeypatch):
    def broken(*_):
        raise ToolchainError("does not run")

    monkeypatch.setattr(verification, "run_code", broken)
    status, out, _ = run(capsys, "verify", "q", "--to", "python")
    assert status == 1
    assert "failed: does not run" in out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["verify", "q", "--to", "fortran"], "allowed: c, cpp"),
        (["verify", "q", "--to", "wgsl", "--precision", "double"], "allowed: half, float"),
        (["verify", "q", "--precision", "quad"], "quad"),
        (["verify", "zz"], "no table"),
        (["verify"], "tables"),
        (["export", "q", "--to", "fortran"], "allowed: c, cpp"),
        (["export", "q", "--to", "wgsl", "--precision", "double"], "allowed: half, float"),
        (["export", "ps", "--to", "glsl", "--precision", "double"], "cannot be written in GLSL"),
        (["export", "q", "--to", "c", "--name", "2x"], "no identifier"),
        (["export", "q", "--to", "hlsl", "--name", "float3"], "cannot be used in HLSL"),
        (["export", "q", "--to", "glsl", "--name", "gl_x"], "cannot be used in GLSL"),
        (["export", "q", "--precision", "half"], "allowed with --to"),
        (["export", "q", "--name", "Fn"], "allowed with --to"),
        (["export", "q", "--constants", "table"], "allowed with --to"),
        (["export", "exact/ps"], "with --to LANG"),
        (["export", "exact/r", "--to", "c"], "no closed form"),
        (["cost", "exact/r"], "no closed form"),
    ],
)
def test_bad_input_is_one_line(capsys, arguments, said):
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert err.startswith("shadefit: ") and err.count("\n") == 1
    assert said in err


def test_export_writes_the_file_whole(capsys, tmp_path):
    path = tmp_path / "deep" / "q.py"
    assert run(capsys, "export", "q", "--to", "python", "-o", str(path))[0] == 0
    status, out, _ = run(capsys, "export", "q", "--to", "python")
    assert status == 0 and out == path.read_text()
    assert "def FuzzAveragePenetration(density):" in out


def test_cost_counts_beside_the_closed_form(capsys):
    _, out, _ = run(capsys, "cost", "ps", "--json")
    rows = {row["function"]: row for row in json.loads(out)["tables"][0]["functions"]}
    assert list(rows) == ["CalcFuzzPsCoeffs", "FuzzPs", "FuzzPsExact"]
    assert [row["evaluated_for"] for row in rows.values()] == [
        "a material", "a direction", "a direction, exact/ps",
    ]  # fmt: skip
    assert (rows["FuzzPs"]["kinds"]["mul"], rows["FuzzPs"]["kinds"]["add"]) == (8, 5)
    assert rows["FuzzPs"]["throughput"] is None
    assert "exact/ps" in run(capsys, "cost", "ps")[1]
    assert "No exact form" in run(capsys, "cost", "g")[1]


def test_cost_measures_throughput(capsys):
    if toolchain("c").missing("float") is not None:
        pytest.skip("gcc is not here")
    _, out, _ = run(capsys, "cost", "q", "--throughput", "--json")
    (row,) = json.loads(out)["tables"][0]["functions"]
    assert row["throughput"]["compiled"] > 0 and row["throughput"]["jax"] > 0
    assert "million" in run(capsys, "cost", "q", "--throughput")[1]


# Options of export


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["q", "-o", "x.h"], ".h is the suffix of several languages"),
        (["q", "-o", "x.txt"], "'x.txt' has no suffix that says what to write"),
        (["q", "--to", "glsl", "-o", "x.hlsl"], "'x.hlsl' is no name for GLSL"),
        (["q", "--to", "c", "-o", "x.json"], "'x.json' is no name for code"),
        (["q", "g"], "2 tables are for code"),
        (["q", "--cosines"], "--cosines True is for code"),
        (["q", "--to", "c", "--namespace", "x"], "namespace 'x' is not possible in C"),
        (["q", "--to", "c", "--name", "fmax"], "name 'fmax' cannot be used in C; allowed: "),
        (["q", "--to", "cpp", "--name", "NAN"], "name 'NAN' cannot be used in C++; allowed: "),
        (["q", "--to", "cpp", "--prefix", "f", "--name", "max"], "name 'fmax' cannot be used"),
        (["q", "--to", "hlsl", "--namespace", "min"], "name 'min' cannot be used in HLSL"),
        (["q", "--to", "cpp", "--namespace", "a b"], "namespace name 'a b' is no identifier"),
        (["q", "--to", "c", "--layout", "vec4"], "allowed with interface material"),
        (["q", "--to", "c", "--interface", "material"], "q has one"),
        (["q", "--to", "c", "--cosines"], "q takes no angle"),
        (["ps", "best/ps-11", "--to", "c"], "occurs twice"),
    ],
)
def test_options_that_contradict_each_other_are_one_line(
    capsys, tmp_path, monkeypatch, arguments, said
):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, "export", *arguments)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1 and said in err
    assert not list(tmp_path.iterdir())


def test_the_language_is_that_of_the_suffix(capsys, tmp_path):
    path = tmp_path / "q.py"
    assert run(capsys, "export", "q", "-o", str(path))[0] == 0
    assert path.read_text() == run(capsys, "export", "q", "--to", "PY")[1]
    table = tmp_path / "q.json"
    assert run(capsys, "export", "q", "-o", str(table))[0] == 0
    assert json.loads(table.read_text())["quantity"] == "q"
    assert table.read_text() == run(capsys, "export", "q", "--to", "json")[1]


@pytest.mark.slow
def test_verify_says_that_half_is_not_good_enough(capsys, monkeypatch):
    few = functools.partial(exported_code.trial_of, exponent=10)
    monkeypatch.setattr(exported_code, "trial_of", few)
    arguments = ["verify", "published/ps", "--to", "python", "--precision", "half"]
    status, out, _ = run(capsys, *arguments, "--json")
    assert status == 0
    (row,) = json.loads(out)["tables"][0]["checks"]
    assert row["status"] == "not good enough"
    assert "allowed" in row["reason"]
    assert "passed" not in run(capsys, *arguments)[1]
