"""Output that cannot be written: what is said of it, and the exit status."""

import json
import os
import subprocess
import sys

import pytest

from coefficients.packaged import packaged_table
from coefficients.table import serialise
from tests.shadefit.test_cli import run

SHADEFIT = f"{sys.executable} -m shadefit"
SAID = "shadefit: standard output cannot be written: "


def shell(script: str, **options) -> tuple[int, str, str]:
    """Run a script in which `shadefit` is the command: status, standard output and error."""
    done = subprocess.run(
        ["sh", "-c", f'shadefit() {{ {SHADEFIT} "$@"; }}\n{script}'],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        **options,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(
    ("command", "status", "said"),
    [
        ("--version >/dev/full", 2, f"{SAID}No space left on device\n"),
        ("--version >&-", 2, f"{SAID}Bad file descriptor\n"),
        ("--version 2>&- <&-", 0, ""),
        ("nothing 2>/dev/full", 2, ""),
        ("nothing 2>&-", 2, ""),
        # Neither stream takes anything.
        ("--version >/dev/full 2>&1", 2, ""),
        ("--version >&- 2>&-", 2, ""),
    ],
)
def test_the_exit_status_tells_of_output_that_is_lost(command, status, said):
    code, out, error = shell(f"shadefit {command}")
    assert (code, error) == (status, said)
    assert out.startswith("shadefit ") is (code == 0)


@pytest.mark.parametrize(("command", "status"), [("--help", 141), ("list --json", 141), ("no", 2)])
def test_a_reader_that_is_gone_is_silent_and_the_status_that_of_other_tools(command, status):
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", "shadefit", *command.split()],
        stdout=writer,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        timeout=120,
    )
    os.close(writer)
    assert done.returncode == status
    assert (done.stderr == "") is (status == 141)


def test_output_that_exceeds_a_limit_is_one_line(tmp_path):
    # Python's own output is a file too. The limit is in units of 512 bytes.
    code, _, error = shell("ulimit -f 4; shadefit list --json > out", cwd=tmp_path)
    assert (code, error) == (2, f"{SAID}File too large\n")


@pytest.mark.slow
def test_a_file_that_exceeds_a_limit_is_one_line_and_the_old_file_stays(tmp_path):
    (tmp_path / "q.json").write_text("old")
    code, out, error = shell("ulimit -f 2; shadefit export q -o q.json", cwd=tmp_path)
    assert (code, out) == (2, "")
    assert error == "shadefit: q.json cannot be written: File too large\n"
    assert (tmp_path / "q.json").read_text() == "old"
    assert sorted(os.listdir(tmp_path)) == ["q.json"]


@pytest.mark.slow
def test_files_go_through_pipes_and_to_standard_output(tmp_path):
    script = """
    exec 3>&1
    shadefit export q -o - | cmp - wanted
    mkfifo pipe
    cmp pipe wanted & shadefit export q --to json -o pipe; wait $!
    shadefit export q --to json -o /dev/fd/3 | cmp - /dev/null
    """
    (tmp_path / "wanted").write_text(serialise(packaged_table("q")))
    code, out, error = shell(script, cwd=tmp_path)
    assert (code, error) == (0, "")
    assert out == serialise(packaged_table("q"))
    assert sorted(os.listdir(tmp_path)) == ["pipe", "wanted"]


@pytest.mark.slow
def test_what_is_said_goes_to_standard_error_if_the_file_is_the_output(
    capfd, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    options = ["bake", "q", "--size", "8", "--format", "csv", "--json"]
    status, out, error = run(capfd, *options, "-o", "-")
    assert status == 0
    assert json.loads(error)["file"] == "-"
    status, said, _ = run(capfd, *options, "-o", "q.csv")
    assert (tmp_path / "q.csv").read_text() == out
    assert json.loads(said)["errors"] == json.loads(error)["errors"]
    assert os.listdir(tmp_path) == ["q.csv"]
