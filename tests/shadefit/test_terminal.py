"""Commands in a real terminal: at several widths, without colours, and interrupted."""

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from coefficients.packaged import names, packaged_table
from programs.rounded_text import rounded_up
from shadefit.outputs import ListOutput
from shadefit.records import ErrorsRecord, TableRecord
from shadefit.terminal import messages_beside, print_json, print_lines, print_table
from tests.shadefit.screen import Session, screen


def shown(*arguments: str, width: int, **environment: str) -> tuple[str, list[str]]:
    """Return the whole output of a command in a terminal, and the lines on its screen."""
    session = Session(*arguments, width=width, **environment)
    assert session.end() == 0, session.output
    return session.output, screen(session.output)


WIDTHS = [pytest.param(60, marks=pytest.mark.slow), 80, pytest.param(100, marks=pytest.mark.slow)]


@pytest.mark.parametrize("width", WIDTHS)
def test_the_numbers_of_a_comparison_are_whole(width):
    _, lines = shown("compare", "q", width=width)
    assert max(map(len, lines)) <= width
    text = "\n".join(lines)
    assert "…" not in text
    assert re.search(
        r"published +4\.6743e-03 +1\.0000 +9\.2892e-03 +1\.0000\n +at density 0.5", text
    )
    assert re.search(r"refitted q +4\.6663e-03 +0\.9983 +1\.0060e-02 +1\.0830\n +at density", text)


@pytest.mark.parametrize("width", [40, 80])
def test_the_list_of_tables_is_whole(width):
    _, lines = shown("list", width=width)
    assert max(map(len, lines)) <= width
    text = " ".join(" ".join(lines).split())
    for name in names():
        assert name in text
        errors = packaged_table(name).errors
        if errors is not None:
            assert f"{errors.off_grid.rms:.3e}" in text
            proven = packaged_table(name).certificates.largest_error
            largest = (
                f"{errors.off_grid.max:.3e}" if proven is None else rounded_up(proven.upper, 4)
            )
            assert largest in text


def test_without_colours_and_on_a_dumb_terminal():
    output, lines = shown("list", width=80, NO_COLOR="1")
    # Bold and dim are no colours: these are the parameters 30 to 49 and 90 to 107.
    codes = {
        int(code) for each in re.findall(r"\x1b\[([\d;]*)m", output) for code in each.split(";")
    }
    assert not [code for code in codes if 30 <= code <= 49 or 90 <= code <= 107]
    plain, same = shown("list", width=80, TERM="dumb")
    assert "\x1b" not in plain
    assert same == lines


@pytest.mark.slow
def test_an_old_encoding_in_a_terminal():
    output, lines = shown("compare", "q", width=80, PYTHONIOENCODING="ascii")
    assert output.isascii()
    assert any(set(line) == {"-"} for line in lines)


def test_in_a_pipe_there_are_no_codes_and_columns_stand_side_by_side():
    command = [sys.executable, "-m", "shadefit", "list"]
    environment = {**os.environ, "COLUMNS": "30"}
    text = subprocess.run(
        command, capture_output=True, text=True, env=environment, check=True
    ).stdout
    assert "\x1b" not in text
    assert re.search(
        r"^best/q-9 +1\.134e-05 +≤ 1\.628e-05\n +of q  form pole-q ", text, re.MULTILINE
    )


def test_lines_of_a_note_are_kept_and_an_empty_cell_below_left_out(capsys):
    note = f"{'word ' * 40}\nmore"
    print_table("title", ["name", "rms", "at"], [["a", "1", ""], ["b", "2", "x 1"]], note, 1)
    lines = capsys.readouterr().out.splitlines()
    assert lines[:6] == ["title", "name  rms", "─" * 10, "a       1", "b       2", "    at x 1"]
    assert lines[6:] == [("word " * 40).strip(), "more", ""]


def test_what_is_said_beside_a_file_on_standard_output_goes_to_standard_error(capsys):
    for files in ([Path("-")], [None, Path("-")], [None, Path("file")], []):
        with messages_beside(*files):
            print_table("title", ["name"], [["a"]])
        out, error = capsys.readouterr()
        assert ("title" in error, "title" in out) == (Path("-") in files, Path("-") not in files)


def test_names_of_files_do_not_steer_the_terminal(capsys):
    name = "\x1b[2J\u202e.json"
    print_table(name, [name], [[name]], name)
    print_lines(Path(name), name)
    out = capsys.readouterr().out
    assert out.count(r"\x1b[2J\u202e.json") == 6
    assert "\x1b" not in out and "\u202e" not in out


def test_an_interruption_leaves_one_clean_line(tmp_path):
    # What is left after g takes seconds, so that the interruption does not come too late.
    session = Session("refit", "ps", "g", "ggx-scale", "ggx-bias", "--out", str(tmp_path))
    session.read_until("ps: ")
    session.read_until("g: ")
    session.type("\x03")
    assert session.end() == 130
    lines = [line for line in screen(session.output) if line]
    assert lines == ["shadefit: interrupted; no file is half written"]
    # The cursor, which the display hides, is shown again.
    assert session.output.rfind("\x1b[?25h") > session.output.rfind("\x1b[?25l")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_progress_leaves_nothing_on_the_screen(tmp_path):
    output, lines = shown("refit", "q", "--grid", "9", "--out", str(tmp_path), "--json", width=80)
    assert "0:00" in output and "q: " in output
    assert json.loads("\n".join(lines))["tables"][0]["name"] == "q"


def test_a_number_that_is_not_finite_is_null_and_has_a_reason(capsys):
    errors = ErrorsRecord(rms=math.inf, max=math.nan, where={"a": -math.inf}, points=3)
    output = ListOutput(tables=[table(errors), table(ErrorsRecord(rms=0.0, max=1.0))])
    print_json(output)
    text = capsys.readouterr().out
    assert json.loads(text)["not_finite"] == {
        "tables[0].errors.rms": "infinity",
        "tables[0].errors.max": "no number",
        "tables[0].errors.where.a": "-infinity",
    }
    assert json.loads(text)["tables"][0]["errors"]["rms"] is None
    read = ListOutput.model_validate_json(text)
    assert math.isnan(read.tables[0].errors.max) and read.tables[1].errors.max == 1.0
    print_json(ListOutput(tables=[table(None)]))
    assert "not_finite" not in capsys.readouterr().out


def test_a_size_is_not_negative():
    with pytest.raises(ValueError, match="is negative"):
        ErrorsRecord(rms=-1.0, max=0.0)


def table(errors):
    fields = {
        "name": "t",
        "kind": "file",
        "quantity": "q",
        "form": None,
        "equation": "",
        "file": "",
    }
    return TableRecord(**fields, errors=errors)
