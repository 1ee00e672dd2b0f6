"""A sixth quantity, which only examples/soft_step.py knows, goes through every command."""

import json
from pathlib import Path

import pytest

import shadefit as sf
from quantities.registry import unregister
from shadefit.cli import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "soft_step.py"
PICTURES = ROOT / "docs" / "figures"
FILE = ["-p", str(EXAMPLE)]


@pytest.fixture(autouse=True)
def _registered():
    yield
    unregister("soft")


@pytest.fixture
def run(capsys):
    def run(*arguments) -> str:
        command, *rest = map(str, arguments)
        with pytest.raises(SystemExit) as ended:
            main([command, *FILE, *rest])
        output = capsys.readouterr()
        assert ended.value.code == 0, output.err
        return output.out

    return run


@pytest.mark.slow
def test_it_is_in_the_report(run, tmp_path):
    """The pictures of the other quantities are those of docs/figures."""
    run("refit", "--out", tmp_path)
    table = tmp_path / "soft.json"
    run("report", table, "--pictures", PICTURES, "--out", tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "S = tanh(x y), a soft step" in page
    assert f'<th scope="row">{table}</th>' in page
    assert "float SoftStep(float x, float y)" in page


@pytest.mark.slow
def test_it_goes_through_every_command(run, tmp_path):
    table = tmp_path / "soft.json"
    largest = {}
    for norm in ("l2", "linf"):
        made = json.loads(run("refit", "--norm", norm, "--out", tmp_path, "--json"))
        largest[norm] = made["tables"][0]["errors"]["max"]
    assert largest["linf"] < 0.9 * largest["l2"]
    assert largest["linf"] < 0.02

    (compared,) = json.loads(run("compare", table, "--json"))["comparisons"]
    assert compared["tables"][0]["errors"]["max"] == pytest.approx(largest["linf"], rel=1e-9)
    told = json.loads(run("evaluate", "soft", "--x", 1, "--y", 0.8, "--table", table, "--json"))
    assert abs(told["tables"][-1]["difference"]) <= largest["linf"]
    for language in sf.LANGUAGES:
        assert "SoftStep" in run("export", table, "--to", language)
    assert "failed" not in run("verify", table, "--to", "c")
    (proven,) = json.loads(run("certify", table, "--json"))["tables"]
    assert proven["state"] == "proven"
    assert 0.999 * largest["linf"] <= proven["largest_error"]["upper"] <= 1.011 * largest["linf"]

    found = json.loads(run("search", "soft", "--out", tmp_path / "search", "--json"))
    assert [each["form"] for each in found["frontier"]] == ["short", "longer"]
    run("figures", "errors-soft", "--out", tmp_path)
    assert (tmp_path / "errors-soft.svg").stat().st_size > 1000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--x", "1"], "--y is missing of soft, which takes --x, --y"),
        (["--x", "1", "--y", "0.8", "--z", "1"], "--z is no argument of soft"),
        (["--x", "9", "--y", "0.8"], "--x = 9 is outside its domain [0, 4]"),
        (["--x", "one", "--y", "0.8"], "'one' is not a valid float"),
    ],
)
def test_its_options_are_those_of_its_axes(capsys, arguments, message):
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", *FILE, "soft", *arguments])
    assert ended.value.code == 2
    assert message in capsys.readouterr().err


def test_a_fit_that_did_not_converge_is_told_on_standard_error(capsys, tmp_path):
    """The best constant of the denominator is 0: 1/(x + x²) is the quantity."""
    file = tmp_path / "vanishing.py"
    file.write_text(
        "from shadefit import Axis, Problem, closed_form\n"
        'p = Problem("vanishing", [Axis("x", 0.5, 2)], closed_form(lambda x: 1 / (x + x * x)))\n'
        'p.rational((0,), (0, 1, 2), name="plain")\n'
        'p.rational((0,), (0, 1, 2), one=1, name="better")\n'
    )
    with pytest.raises(SystemExit) as ended:
        main(["refit", "-p", str(file), "--form", "all", "--out", str(tmp_path / "tables")])
    assert ended.value.code == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("warning: vanishing did not converge: ")
    assert "let another term of the denominator be 1, such as that of b" in line
    unregister("vanishing")


def test_the_declaration_is_short():
    assert len(EXAMPLE.read_text().splitlines()) < 60


def test_without_a_folder_its_table_is_not_written_into_the_package(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["refit", *FILE])
    assert ended.value.code == 2
    assert "soft has no folder of its own: give one by --out" in capsys.readouterr().err
