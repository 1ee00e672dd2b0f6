"""The command `certify`."""

import json

import pytest

from coefficients.packaged import packaged_table
from coefficients.table import read, serialise
from fitting.proofs import largest_error
from programs.bounding.compiled import compiler_missing
from quantities.fuzz import r_error
from shadefit.cli import main
from tests.coefficients.changed import put

needs_compiler = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    captured = capsys.readouterr()
    return stopped.value.code, captured.out, captured.err


@needs_compiler
def test_tables_are_proven_printed_and_written(capsys, tmp_path, monkeypatch):
    # R has no proof for so small a roughness.
    monkeypatch.setattr(r_error, "LEAST_ALPHA", 0.5)
    status, out, _ = run(capsys, "certify", "best/q-9", "r", "--json", "--out", str(tmp_path))
    assert status == 0
    first, second = json.loads(out)["tables"]
    assert (first["state"], second["state"]) == ("proven", "sampled")
    assert second["largest_error"] is None
    record = read(tmp_path / "q-9.json").certificates.largest_error
    assert record.model_dump() == first["largest_error"]
    assert list(tmp_path.iterdir()) == [tmp_path / "q-9.json"]
    status, out, _ = run(capsys, "certify", str(tmp_path / "q-9.json"))
    assert status == 0
    assert "proven" in out and "density 0.5" in out


@needs_compiler
@pytest.mark.parametrize(
    "place", [("errors", "off_grid", "max"), ("certificates", "largest_error", "upper")]
)
def test_a_table_that_states_less_than_an_error_fails(capsys, tmp_path, place):
    data = json.loads(serialise(packaged_table("best/q-9")))
    put("certificates", "largest_error", "lower", 0.0)(data)
    put(*place, 0.99 * data["errors"]["off_grid"]["max"])(data)
    path = tmp_path / "table.json"
    path.write_text(json.dumps(data))
    status, out, _ = run(capsys, "certify", str(path))
    assert status == 1
    assert "proven, understated" in out


@needs_compiler
@pytest.mark.slow
def test_the_rounding_of_code_is_proven_printed_and_written(capsys, tmp_path):
    status, out, _ = run(
        capsys, "certify", "best/q-4", "--rounding", "--json", "--out", str(tmp_path)
    )
    assert status == 0
    (found,) = json.loads(out)["tables"]
    assert (found["state"], found["largest_error"]) == ("proven", None)
    rounding = found["rounding"]
    assert 0 < rounding["measured"] < rounding["upper"]["ieee"] < rounding["upper"]["vulkan"] < 1e-6
    record = read(tmp_path / "q-4.json").certificates.float32_rounding
    assert record.ieee.upper == rounding["upper"]["ieee"]
    status, out, _ = run(capsys, "certify", "exact/q", "--rounding")
    assert status == 1 and "not proven" in out


@needs_compiler
def test_a_claim_that_is_wrong_is_refuted(capsys):
    status, out, _ = run(capsys, "certify", "best/q-4", "--at-most", "6.9e-4", "--json")
    assert status == 1
    (found,) = json.loads(out)["tables"]
    assert found["state"] == "refuted"
    assert found["largest_error"]["lower"] > 6.9e-4 and found["largest_error"]["upper"] is None
    status, out, _ = run(capsys, "certify", "best/q-4", "--at-most", "7e-4")
    assert status == 0 and "proven" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("best/q-4", "--threads", "257"), "less than or equal to 256"),
        (("best/q-4", "--upper-ratio", "1"), "upper ratio 1: allowed is a finite number above 1"),
        (
            ("best/q-4", "--upper-ratio", "inf"),
            "upper ratio inf: allowed is a finite number above 1",
        ),
        (("best/q-4", "--at-most", "-1"), "--at-most -1: allowed is a positive number"),
        (("exact/q",), "exact/q has no coefficients"),
        (("best/q-4", "--rounding", "--at-most", "1"), "--at-most with --rounding"),
        (("nothing",), "no table is called 'nothing'"),
        (("best/q-4", "--threads", "0"), "--threads"),
    ],
)
def test_bad_input_is_one_line(capsys, arguments, message):
    status, out, error = run(capsys, "certify", *arguments)
    assert (status, out) == (2, "")
    assert message in error and error.count("\n") == 1


def test_without_a_compiler_p_s_cannot_be_proven(capsys, monkeypatch):
    monkeypatch.setattr(largest_error, "compiler_missing", lambda: "gcc is not on PATH")
    status, out, error = run(capsys, "certify", "best/ps-11")
    assert (status, out) == (2, "")
    assert "needs a C compiler: gcc is not on PATH" in error
    status, out, _ = run(capsys, "certify", "best/q-4", "--upper-ratio", "1.05")
    assert status == 0 and "proven" in out
