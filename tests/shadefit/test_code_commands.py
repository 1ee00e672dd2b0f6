"""The commands about exported code: `export --to`, `verify` and `cost`."""

import json

import pytest

from programs import PRECISIONS, ToolchainError, toolchain
from programs.toolchains import verification
from programs.toolchains.interface import Toolchain
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
