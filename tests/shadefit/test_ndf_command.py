"""`shadefit ndf`: from a file or a name to a table and to code; bad input is one line."""

import json
import math

import pytest

from coefficients.ndf_table import read_ndf
from shadefit.cli import main
from tests.shadefit.test_records import CHECKED


def run(*arguments) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["ndf", *map(str, arguments)])
    return ended.value.code


@pytest.mark.slow
def test_a_table_is_read(tmp_path, capsys):
    table = {"schema": "shadefit.ndf/1", "target": "steps", "linear_in": "cos2", "monotone": True}
    table |= {"knots": [0.0, 1.0, math.pi / 2], "values": [0.5, 0.25, 0.0], "mass": 1.0}
    table |= {
        "errors": {"total_variation": 0.5, "masking": 0.1, "directions": 9},
        "command": "none",
    }
    file, copy = tmp_path / "steps.json", tmp_path / "copy.json"
    file.write_text(json.dumps(table))
    assert run(file, "--out", copy, "--json") == 0
    assert CHECKED.validate_json(capsys.readouterr().out).values == table["values"]
    assert json.loads(copy.read_text()) == table
    assert run(file, "--cost") == 0
    printed = capsys.readouterr().out
    assert "1.00e-01" in printed
    assert "NdfVisibleNormal" in printed


@pytest.mark.slow
def test_the_cost_beside_textures_is_stated(tmp_path, capsys):
    table = {"schema": "shadefit.ndf/1", "target": "steps", "linear_in": "cos2", "monotone": True}
    table |= {"knots": [0.0, 1.0, math.pi / 2], "values": [0.5, 0.25, 0.0], "mass": 1.0}
    table |= {
        "errors": {"total_variation": 0.5, "masking": 0.1, "directions": 9},
        "command": "none",
    }
    file = tmp_path / "steps.json"
    file.write_text(json.dumps(table))
    assert run(file, "--cost", "--json") == 0
    costs = {each.function: each for each in CHECKED.validate_json(capsys.readouterr().out).costs}
    assert costs["NdfVisibility"].operations == 6
    assert costs["NdfHidden"].axes == "NdotV"
    few, many = costs["NdfHidden"].textures
    # Linear interpolation of a smooth function: the error falls with the square of the step.
    assert few.texels == 32
    assert many.texels == 128
    assert many.error < few.error / 8
    assert costs["NdfHidden"].rounding < 1e-6
    file.write_text(json.dumps(table | {"linear_in": "angle"}))
    assert run(file, "--cost") == 2


@pytest.mark.slow
def test_a_fit_is_written_and_exported(tmp_path, capsys):
    file, code = tmp_path / "ggx.json", tmp_path / "ggx.glsl"
    assert run("ggx:0.2", "--segments", 12, "--out", file, "--json") == 0
    said = CHECKED.validate_json(capsys.readouterr().out)
    table = read_ndf(file)
    assert (said.segments, said.files) == (12, [str(file)])
    assert table.values == said.values
    assert run(file, "--to", "glsl", "--code", code, "--name", "Lobe") == 0
    assert "float LobeHidden(float NdotV)" in code.read_text()
    assert "total variation" in capsys.readouterr().out
    # The command in the table makes it again.
    again = tmp_path / "again.json"
    assert run(*table.command.split()[2:], "--out", again) == 0
    assert again.read_text() == file.read_text()


@pytest.mark.slow
def test_a_blend_of_two_sources_is_fitted_and_exported(tmp_path, capsys):
    file, code = tmp_path / "blend.json", tmp_path / "blend.hlsl"
    given = ("beckmann:0.3", "--across", "beckmann:0.4", "--segments", 6, "--out", file, "--json")
    assert run(*given) == 0
    said = CHECKED.validate_json(capsys.readouterr().out)
    table = read_ndf(file)
    assert said.across.values == table.y.values
    assert (said.total_variation, said.values) == (None, table.x.values)
    assert run(file, "--to", "hlsl", "--code", code) == 0
    assert "NdfHidden(float Vx, float Vy, float Vz)" in code.read_text()
    assert "not known" in capsys.readouterr().out


@pytest.mark.slow
def test_two_widths_are_fitted_by_a_blend(tmp_path, capsys):
    file, again = tmp_path / "blend.json", tmp_path / "again.json"
    assert run("ggx:0.3,0.4", "--segments", 8, "--monotone", "--out", file, "--json") == 0
    said = CHECKED.validate_json(capsys.readouterr().out)
    # 0.021 is what the blend of both slices has at best.
    assert said.total_variation < 0.0205
    assert run(*read_ndf(file).command.split()[2:], "--out", again) == 0
    assert again.read_text() == file.read_text()


@pytest.mark.slow
def test_the_columns_of_a_file(tmp_path, capsys):
    path = tmp_path / "lobe.csv"
    rows = [f"{t},{(90 - t) ** 2}" for t in range(0, 91, 10)]
    path.write_text("\n".join(["angle,D", *rows]))
    assert run(path, "--theta", "angle", "--degrees", "--segments", 6, "--json") == 0
    assert json.loads(capsys.readouterr().out)["target"] == "lobe.csv"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nope"], "'nope' is no NDF: allowed are ggx:WIDTH"),
        (["none.csv"], "none.csv"),
        (["ggx:0.02", "--segments", "4"], "miss the peak"),
        (["ggx:0.2", "--linear-in", "cos"], "allowed are cos2, angle"),
        (["ggx:0.2", "--verify"], "give --to"),
        (["ggx:0.2,0.3", "--across", "ggx:0.1"], "allowed are two isotropic sources"),
        (["table.json", "--across", "ggx:0.1"], "with a source that is fitted"),
        (["ggx:0.2", "--to", "c"], "--to needs --code"),
        (["ggx:0.2", "--to", "fortran", "--verify"], "allowed: c, cpp"),
        (["ggx:0.2", "--to", "c", "--verify", "--linear-in", "angle"], "cos2 only"),
        (
            ["ggx:0.3", "-o", "a", "--to", "c", "--code", "a"],
            "--out and --code are both a: allowed are two files",
        ),
    ],
)
def test_bad_input_is_one_line(arguments, said, capsys):
    assert run(*arguments) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
