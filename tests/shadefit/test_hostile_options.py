"""Options that nobody means: each is refused in one line that can be shown on a terminal."""

import os

import pytest

from tests.shadefit.test_cli import refuses

LONG = "x" * 300
# Each takes a path, to read or to write; what is refused comes before long work.
READ = [
    ["export", "PATH"],
    ["cost", "PATH.json"],
    ["evaluate", "q", "--density", "1", "--table", "PATH.json"],
    ["evaluate", "q", "--points", "PATH.csv"],
    ["bake", "PATH.json", "--size", "4", "--format", "csv"],
    ["list", "-p", "PATH.py"],
    ["fit", "PATH.csv", "--x", "a", "--y", "b", "--form", "polynomial:1"],
    ["ndf", "PATH.json"],
    ["curvature", "PATH.ply", "--unit", "mm"],
    ["detail", "compose", "PATH.png", "PATH.png", "--colour-space", "srgb", "-o", "o.png"],
]
WRITTEN = [
    ["export", "q", "-o", "PATH.json"],
    ["evaluate", "q", "--points", "points.csv", "--out", "PATH.csv"],
    ["bake", "q", "--size", "4", "--format", "csv", "-o", "PATH"],
    ["refit", "q", "--out", "PATH"],
    ["search", "q", "--out", "PATH"],
    ["certify", "q", "--out", "PATH"],
    ["ndf", "ggx:0.3", "-o", "PATH"],
    ["new", "lobe", "--out", "PATH"],
    ["figures", "--out", "PATH"],
    ["render", "--out", "PATH"],
    ["report", "--out", "PATH"],
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder, in which the commands run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "points.csv").write_text("density\n0.5\n")
    (tmp_path / "data.csv").write_text("a,b\n0,1\n0.5,2\n1,3\n")
    return tmp_path


def refused(capsys, folder, command: list[str], **replaced: str) -> str:
    """Check that a command is refused in one line, and writes nothing; return the line."""
    before = os.listdir(folder)
    for key, value in replaced.items():
        command = [word.replace(key, value) for word in command]
    said = refuses(capsys, *command)
    assert os.listdir(folder) == before
    assert said.strip("\n").isprintable()
    # What is allowed may be a long list; what was given is not repeated as a whole.
    assert len(said) < 4000
    return said


@pytest.mark.parametrize("command", [*READ, *WRITTEN], ids=" ".join)
def test_a_path_that_is_too_long_is_refused(capsys, folder, command):
    refused(capsys, folder, command, PATH=LONG)


@pytest.mark.parametrize("command", WRITTEN, ids=" ".join)
def test_a_path_below_a_link_to_itself_is_refused(capsys, folder, command):
    (folder / "loop").symlink_to("loop")
    assert "loop" in refused(capsys, folder, command, PATH="loop/deeper")


@pytest.mark.parametrize("command", READ, ids=" ".join)
def test_a_name_that_would_steer_the_terminal_is_shown_as_it_is(capsys, folder, command):
    said = refused(capsys, folder, command, PATH="\x1b]0;owned\x07\u202egnp\udcff")
    assert r"\x1b]0;owned\x07\u202egnp\udcff" in said.replace("\\\\", "\\")


def test_an_error_of_the_system_anywhere_is_one_line(capsys, folder, monkeypatch):
    def refuse(*_):
        raise PermissionError(13, "Permission denied", "some/file")

    monkeypatch.setattr("shadefit.commands.new.problem_file", refuse)
    assert refused(capsys, folder, ["new", "lobe"]) == "shadefit: some/file: Permission denied\n"

    def exhaust(*_):
        raise MemoryError

    monkeypatch.setattr("shadefit.commands.new.problem_file", exhaust)
    assert "the memory does not suffice" in refused(capsys, folder, ["new", "lobe"])


FORM = ["fit", "data.csv", "--x", "a", "--y", "b", "--form"]


@pytest.mark.parametrize(
    "command",
    [
        ["render", "--size", "N"],
        ["render", "--size", "-N"],
        ["bake", "g", "--size", "NxN", "--format", "csv"],
        ["refit", "q", "--grid", "N"],
        ["evaluate", "q", "--density", "1", "--samples", "N"],
        ["evaluate", "q", "--density", "1", "--seed", "N"],
        ["evaluate", "q", "--density", "N"],
        ["ndf", "ggx:N"],
        ["ndf", "ggx:0.3", "--segments", "N"],
        *([*FORM, f"{kind}:{numbers}"] for kind, numbers in (
            ("rational", "N,2"),
            ("polynomial", "N"),
            ("chebyshev", "N"),
            ("exponentials", "N"),
            ("poles", "1,N"),
            ("piecewise", "N"),
        )),
        [*FORM, "polynomial:1", "--hold-out", "N"],
    ],
    ids=" ".join,
)  # fmt: skip
@pytest.mark.parametrize("digits", [400, 5000])
def test_a_number_of_many_digits_is_refused(capsys, folder, command, digits):
    refused(capsys, folder, command, N="9" * digits)
