"""The command line: what it prints, what it refuses, and that refusing leaves nothing behind."""

import inspect
import json
import math
import signal
import subprocess
import sys
import time

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from coefficients import files, packaged
from coefficients.catalogue import entries, resolve
from coefficients.packaged import FOLDER, names
from coefficients.table import Table, parse, serialise
from quantities import problems
from shadefit.cli import main
from shadefit.commands import refit
from shadefit.commands.ambient import ambient
from shadefit.commands.figures import figures
from shadefit.commands.options import angle
from shadefit.commands.render import render
from shadefit.commands.report import report
from shadefit.commands.search import search
from shadefit.commands.selection import table_name

NAMES = names()
REFERENCES = {name: problem.reference for name, problem in problems().items()}
PS_POINT = ["--alpha", "0.35", "--theta-f", "45deg", "--theta-u", "30deg", "--phi", "90deg"]
POINTS = {
    "ps": PS_POINT,
    "g": ["--density", "0.2", "--cos-v", "0.5"],
    "q": ["--density", "0.2"],
    "r": ["--alpha", "0.35", "--theta-f", "45deg"],
    "velvet": ["--asymmetry", "-0.5"],
    "ggx-directional-albedo": ["--mu", "0.3", "--alpha", "0.4"],
    "ggx-scale": ["--mu", "0.3", "--alpha", "0.4"],
    "ggx-bias": ["--mu", "0.3", "--alpha", "0.4"],
    "ggx-average-albedo": ["--alpha", "0.4"],
    "sggx-filter": ["--share", "0.4"],
    "sggx-filter-axes": ["--along", "0.4", "--across", "0.2"],
    **{
        f"skin-{surface}-{channel}": ["--cosine", "0.2", "--curvature", "0.1"]
        for surface in ("cylinder", "sphere")
        for channel in ("red", "green", "blue")
    },
    "skin-lobe-cylinder": ["--cosine", "0.2", "--width", "0.3"],
    "skin-lobe-sphere": ["--cosine", "0.2", "--width", "0.3"],
    **{
        f"skin-band-{band}-{channel}": ["--curvature", "0.1"]
        for band in (1, 2)
        for channel in ("red", "green", "blue")
    },
}


def table_of(name: str) -> Table:
    return resolve(name).require_table()


def run(capsys, *arguments):
    """Run the command line in this process: exit status, standard output, standard error."""
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    captured = capsys.readouterr()
    return stopped.value.code, captured.out, captured.err


def refuses(capsys, *arguments):
    status, out, err = run(capsys, *arguments)
    assert status == 2, (arguments, out, err)
    assert out == ""
    assert err.startswith("shadefit: ")
    assert err.count("\n") == 1
    return err


def is_density(text):
    try:
        return math.isfinite(float(text)) and float(text) >= 0
    except ValueError:
        return False


# The legs of the others take seconds to compile, and tests/integrals compares them.
SLOW_TO_EVALUATE = ("ggx-directional-albedo", "r", "g", "skin-cylinder-red")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow) if name in SLOW_TO_EVALUATE else name
        for name in REFERENCES
    ],
)
def test_evaluate_gives_every_leg_within_its_error(capsys, name):
    status, out, _ = run(capsys, "evaluate", name, *POINTS[name], "--json")
    assert status == 0
    result = json.loads(out)
    assert set(result["legs"]) == set(REFERENCES[name].legs)
    exact = result["legs"][REFERENCES[name].best_leg]
    for leg_name, leg in result["legs"].items():
        allowed = 5 * leg["error"] if leg_name == "monte_carlo" else leg["error"]
        assert abs(leg["value"] - exact["value"]) <= allowed + exact["error"]
    # Published P_s is off by at most 0.14, and the published filters are the only worse ones.
    for table in result["tables"]:
        assert abs(table["difference"]) < (0.42 if name.startswith("sggx") else 0.15)
    best = [each.name for each in entries(problems()[name]) if each.kind == "best"]
    assert [table["label"] for table in result["tables"] if table["kind"] == "best"] == best


def test_evaluate_outside_a_fits_domain_gives_no_number_for_it(capsys):
    arguments = ["--alpha", "0.35", "--theta-f", "1deg", "--theta-u", "30deg", "--phi", "0"]
    _, out, _ = run(capsys, "evaluate", "ps", *arguments, "--json")
    result = json.loads(out)
    published = result["tables"][0]
    assert published["label"] == "published"
    assert published["value"] is None
    assert "theta_f" in published["reason"]
    assert result["legs"]["closed_form"]["value"] > 0


def test_evaluate_shows_the_tables_that_are_asked_for(capsys, tmp_path):
    path = str(tmp_path / "mine.json")
    assert run(capsys, "export", "best/q-9", "-o", path)[0] == 0
    own = ["--table", "best/q-9", "--table", path]
    _, out, _ = run(capsys, "evaluate", "q", "--d", "0.3", *own, "--json")
    tables = {table["label"]: table for table in json.loads(out)["tables"]}
    best = ["best/q-12", "best/q-12-log", "best/q-4", "best/q-5", "best/q-9"]
    assert list(tables) == ["published", "refitted", *best, path]
    assert tables["best/q-9"]["value"] == tables[path]["value"]
    assert tables[path]["kind"] == "file" and tables[path]["file"] == path
    stated = table_of("best/q-9").errors
    assert stated is not None
    assert abs(tables[path]["difference"]) <= stated.off_grid.max
    _, out, _ = run(capsys, "evaluate", "q", "--d", "0.3", *own)
    rows = [line.split() for line in out.splitlines() if line.startswith(("best/q-9", path))]
    assert [float(row[1]) for row in rows] == pytest.approx([tables[path]["value"]] * 2)


def test_monte_carlo_is_reproducible_and_depends_on_the_seed(capsys):
    outputs = [
        run(capsys, "evaluate", "q", "--density", "0.3", "--seed", seed, "--json")[1]
        for seed in ("1", "1", "2")
    ]
    assert outputs[0] == outputs[1] != outputs[2]


def test_refit_writes_valid_tables_and_the_same_bytes_twice(capsys, tmp_path):
    for folder in ("a", "b"):
        out = str(tmp_path / folder)
        status, _, _ = run(capsys, "refit", "q", "g", "--grid", "17", "--out", out)
        assert status == 0
    for name in ("q", "g"):
        first, second = ((tmp_path / folder / f"{name}.json").read_bytes() for folder in "ab")
        assert first == second
        assert parse(first.decode(), name).name == name
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == ["g.json", "q.json"]


def test_refit_does_not_warn_of_a_convergence_that_was_not_examined(capsys, tmp_path):
    """The solver of velvet is a linear program of its own."""
    status, _, error = run(capsys, "refit", "velvet", "--grid", "9", "--out", str(tmp_path))
    assert status == 0
    assert "warning" not in error


def test_a_refit_replaces_the_table_that_is_loaded_wherever_the_command_is_run(
    capsys, tmp_path, monkeypatch
):
    written = []
    monkeypatch.setattr(refit, "_table", lambda each, *_: (table_of(table_name(each)), None, ""))
    monkeypatch.setattr(files, "write_whole", lambda path, _: written.append(path.absolute()))
    own = [FOLDER / "fuzz" / "refit" / "q.json", FOLDER / "fuzz" / "best" / "q-4.json"]
    for folder, said in (
        (tmp_path, own),
        (FOLDER.parent, [x.relative_to(FOLDER.parent) for x in own]),
    ):
        monkeypatch.chdir(folder)
        status, out, _ = run(capsys, "refit", "q", "best/q-4", "--json")
        assert status == 0
        assert [table["file"] for table in json.loads(out)["tables"]] == list(map(str, said))
    assert written == own * 2
    assert not list(tmp_path.iterdir())


def test_an_installed_package_is_not_written_into(capsys, monkeypatch):
    monkeypatch.setattr(packaged, "in_checkout", lambda: False)
    for name in ("q", "best/q-4"):
        said = refuses(capsys, "refit", name)
        assert f"{name} comes with an installed package: give a folder by --out" in said


def test_a_checkout_is_known_by_its_project_file(monkeypatch, tmp_path):
    assert packaged.in_checkout()
    monkeypatch.setattr(packaged, "FOLDER", tmp_path / "site-packages" / "coefficients" / "tables")
    assert not packaged.in_checkout()


@pytest.mark.parametrize(
    ("root", "project", "ours"),
    [
        ("checkout", '[project]\nname = "shadefit"\n', True),
        # Other packages have such files too, and install them by mistake.
        ("vendored", '[project]\nname = "other"\n', False),
        ("vendored", "[tool.black]\n", False),
        ("vendored", "project = 1\n", False),
        ("vendored", "no project file", False),
        ("site-packages", '[project]\nname = "shadefit"\n', False),
        ("dist-packages", '[project]\nname = "shadefit"\n', False),
    ],
)
def test_only_the_project_file_of_a_checkout_counts(monkeypatch, tmp_path, root, project, ours):
    monkeypatch.setattr(packaged, "FOLDER", tmp_path / root / "coefficients" / "tables")
    (tmp_path / root).mkdir()
    (tmp_path / root / "pyproject.toml").write_text(project)
    assert packaged.in_checkout() is ours


@pytest.mark.parametrize(
    "command",
    [ambient, figures, refit.refit, render, report, search],
    ids=lambda each: each.__name__,
)
def test_no_default_output_is_a_tracked_file(command):
    default = inspect.signature(command).parameters["out"].default
    # A refit replaces its table in a checkout, and needs --out elsewhere.
    assert default is None if command is refit.refit else default.parts[0] == "build"


def test_compare_measures_each_table_against_the_exact_integral(capsys):
    status, out, _ = run(capsys, "compare", "q", "--json")
    assert status == 0
    (comparison,) = json.loads(out)["comparisons"]
    published, refitted = comparison["tables"]
    assert published["label"] == "published"
    before, after = published["errors"], refitted["errors"]
    assert after["rms"] <= before["rms"]
    assert refitted["ratios"]["rms"] == pytest.approx(after["rms"] / before["rms"])
    assert refitted["ratios"]["max"] == pytest.approx(after["max"] / before["max"])
    assert refitted["coefficients"] == table_of("q").coefficients
    assert comparison["largest_difference"]["value"] > 0


def test_compare_prints_a_table(capsys):
    status, out, _ = run(capsys, "compare", "q")
    assert status == 0
    assert "published" in out
    assert "refitted q" in out
    assert "-1.7280754" in out


@pytest.mark.parametrize("name", names())
def test_export_prints_what_a_name_stands_for(capsys, name):
    status, out, _ = run(capsys, "export", name)
    assert status == 0
    assert parse(out, name) == table_of(name)


def test_export_writes_a_file_that_can_be_named_in_its_turn(capsys, tmp_path):
    path = tmp_path / "deep" / "r.json"
    assert run(capsys, "export", "r", "-o", str(path))[0] == 0
    assert run(capsys, "export", str(path))[1] == path.read_text()


def test_list_names_every_table(capsys):
    _, out, _ = run(capsys, "list", "--json")
    assert [row["name"] for row in json.loads(out)["tables"]] == list(names())


@pytest.mark.parametrize("command", [[], ["refit"], ["compare"], ["evaluate"], ["export"]])
def test_help_has_an_example(capsys, command):
    status, out, _ = run(capsys, *command, "--help")
    assert status == 0
    assert "Example" in out


def test_version(capsys):
    assert run(capsys, "--version")[1].startswith("shadefit ")


@pytest.mark.parametrize(
    ("text", "radians"),
    [
        ("45deg", math.pi / 4),
        ("90 deg", math.pi / 2),
        ("0.5", 0.5),
        ("-.5rad", -0.5),
        ("1e-3", 1e-3),
    ],
)
def test_angles(text, radians):
    assert angle(text) == radians


@pytest.mark.parametrize(
    "arguments",
    [
        ["evaluate", "ps", *PS_POINT[2:]],
        ["evaluate", "ps", *PS_POINT, "--density", "1"],
        ["evaluate", "q", "--density", "inf"],
        ["evaluate", "q", "--density", "-0.1"],
        ["evaluate", "q", "--density", "0.1", "--samples", "1"],
        ["evaluate", "q", "--density", "0.1", "--seed", "-1"],
        ["evaluate", "q", "--density", "0.1", "--sequence", "sobol", "--samples", "100"],
        ["evaluate", "q", "--density", "0.1", "--table", "best/g-9"],
        ["evaluate", "q", "--density", "0.1", "--table", "best/nothing"],
        ["evaluate", "velvet", "--asymmetry", "0.1"],
        ["evaluate", "velvet", "--asymmetry", "-1"],
        ["refit", "ps", "--weight", "none"],
        ["refit", "velvet", "--norm", "linf"],
        ["search", "velvet"],
        ["compare", "published/zz"],
        ["compare", "published/velvet"],
        ["export", "published/ps@"],
        ["export", "ps@printed"],
        ["--frobnicate"],
        ["frobnicate"],
    ],
)
def test_bad_input_is_one_line(capsys, arguments):
    refuses(capsys, *arguments)


@pytest.mark.parametrize("numerator", [3, 10**30, 0.5, "ab"])
def test_a_file_whose_shape_is_none_is_refused(capsys, tmp_path, numerator):
    data = json.loads(serialise(table_of("best/r-25")))
    data["shape"]["numerator"] = numerator
    path = tmp_path / "r.json"
    path.write_text(json.dumps(data))
    assert "numerator = " in refuses(capsys, "compare", str(path))


@pytest.mark.parametrize("command", [["compare"], ["export", "--to", "c"], ["export"], ["cost"]])
def test_a_file_that_would_steer_the_terminal_is_refused(capsys, tmp_path, command):
    path = tmp_path / "q.json"
    path.write_text(
        json.dumps({**json.loads(serialise(table_of("q"))), "equation": "\x1b]0;owned\a"})
    )
    assert refuses(capsys, *command, str(path)).strip("\n").isprintable()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["evaluate", "ps", "--alpha", "1", "--theta-f", "45", "--theta-u", "0", "--phi", "0"],
            "--theta-f = 45 rad is outside its domain [0, 1.5708] rad; in degrees, 0deg to 90deg",
        ),
        (["evaluate", "g", "--d", "0", "--nu", "0"], "G has no limit at density 0, cos_v 0"),
        (["evaluate", "g", "--d", "0", "--nu", "2"], "--cos-v = 2 is outside its domain [0, 1]"),
        (["render", "--sun-azimuth", "500"], "in degrees, -360deg to 360deg"),
        (["render", "--size", "1025"], "--size = 1025 is outside its domain [16, 1024]"),
        (
            ["evaluate", "q", "--d", "0", "--sequence", "halton"],
            "Invalid value for '--sequence': 'halton' is not one of 'random', 'sobol'.",
        ),
        (["export", "exact/q"], "exact/q has no coefficients: allowed is exact/q with --to LANG"),
        (
            ["export", "exact/r", "--to", "c"],
            "allowed are exact/ps, exact/g, exact/q",
        ),
        (["cost", "exact/r"], "no closed form is exported as 'exact/r'"),
        (["compare", "exact/q"], "exact/q has no coefficients"),
        (["evaluate", "q", "--density"], "Option '--density' requires an argument."),
        (["export", "exact/none.json", "--to", "c"], "exact/none.json"),
    ],
)
def test_a_refusal_names_the_option_its_unit_and_what_is_allowed(capsys, arguments, words):
    assert words in refuses(capsys, *arguments)


@pytest.mark.parametrize("grid", ["1", "0", "-3", "8", "1026", "x", "1e9"])
def test_a_grid_that_cannot_be_fitted_is_refused(capsys, tmp_path, grid):
    refuses(capsys, "refit", "all", "--grid", grid, "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_is_refused_before_the_work(capsys, tmp_path):
    file = tmp_path / "file"
    file.write_text("kept")
    assert "no folder" in refuses(capsys, "refit", "q", "--out", str(file / "below"))
    assert file.read_text() == "kept"


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(value=st.floats(allow_nan=True, allow_infinity=True) | st.text(max_size=12))
@example(value=math.nan)
@example(value="1e999")
@example(value="--json")
@pytest.mark.slow
def test_any_density_is_evaluated_or_refused(capsys, value):
    text = str(value)
    arguments = ["evaluate", "q", f"--density={text}", "--samples", "64", "--json"]
    status, out, err = run(capsys, *arguments)
    if status == 0:
        result = json.loads(out)
        assert result["where"]["density"] == float(text)
        assert 0 <= result["legs"]["closed_form"]["value"] <= 1
    else:
        assert status == 2
        assert out == ""
        assert err.count("\n") == 1
        assert not is_density(text)


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(text=st.text(max_size=20).filter(lambda t: t not in NAMES))
def test_any_other_table_name_is_refused(capsys, text):
    refuses(capsys, "export", "--", text)


def interrupted(*arguments: str, after: float) -> tuple[int, str, str]:
    """Run the command line in a process that gets SIGINT: its status and what it wrote."""
    # A shell that starts others in the background has them ignore it.
    code = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from shadefit.__main__ import main; print('begun', flush=True); main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == b"begun\n"
    time.sleep(after)
    sent = time.monotonic()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert time.monotonic() - sent < 10
    return process.returncode, out.decode(), err.decode()


@pytest.mark.parametrize(
    ("arguments", "after", "said"),
    [
        (["evaluate", "r", "--alpha", "0.2", "--theta-f", "1"], 0.5, "no file is half written"),
        (["search", "q"], 3.0, "what it finished is in its folder, and the same command goes on"),
        (["refit", "ps"], 4.0, "no file is half written"),
    ],
)
def test_an_interruption_is_at_once_and_says_what_is_left(tmp_path, arguments, after, said):
    """Whether the command is importing, compiling or computing."""
    given = [] if arguments[0] == "evaluate" else ["--out", str(tmp_path)]
    status, out, err = interrupted(*arguments, *given, after=after)
    assert (status, out) == (130, "")
    *progress, last = err.splitlines()
    assert last.startswith(f"shadefit: interrupted; {said}")
    # Without a terminal, a search says from time to time how far it is.
    assert all(arguments[0] == "search" and line.startswith("q: ") for line in progress)
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


@pytest.mark.slow
def test_an_interrupted_refit_leaves_the_old_table(tmp_path):
    table = tmp_path / "ps.json"
    table.write_text("old")
    assert interrupted("refit", "ps", "--out", str(tmp_path), after=3)[0] == 130
    assert table.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["ps.json"]
