"""Saves of commands that fail at any operation: every file is the old one or the new."""

import ast
import itertools
import json
from collections.abc import Sequence
from pathlib import Path

import pytest

import shadefit
from coefficients import files, packaged
from coefficients.catalogue import resolve
from coefficients.search import Search
from coefficients.table import parse, serialise
from fitting import Goal
from quantities import problem
from shadefit.commands import refit
from shadefit.commands.selection import table_name
from tests.coefficients.test_files import Faulty
from tests.shadefit.test_cli import run

OLD = "the old content\n"
# The command, and the files that it writes.
COMMANDS = {
    "export": (["export", "q", "-o", "q.json"], ["q.json"]),
    "export of code": (["export", "detail/smooth-overlay", "--to", "c", "-o", "a.c"], ["a.c"]),
    "refit": (["refit", "q", "g", "--out", "tables"], ["tables/q.json", "tables/g.json"]),
    "report": (["report", "--out", "report.html"], ["report.html"]),
    "new": (["new", "lobe"], ["lobe.py"]),
    "bake": (["bake", "q", "--size", "8", "--format", "csv", "-o", "q.csv"], ["q.csv"]),
}
SLOW = ("bake", "export", "export of code", "refit", "report")


@pytest.fixture
def at_once(monkeypatch, tmp_path):
    """Run in an empty folder, without the work before the saves."""
    table = lambda each, *_: (resolve(table_name(each)).require_table(), None, "")  # noqa: E731
    monkeypatch.setattr(refit, "_table", table)
    monkeypatch.setattr("shadefit.figures.pictures", dict)
    monkeypatch.setattr("shadefit.report.page.page", lambda *_: "<html>the new page</html>\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def found(folder: Path) -> dict[str, str]:
    """Return the names of all files below a folder, with their texts."""
    every = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_text() for path in every}


def to_fail(operations: Sequence[str]) -> list[int]:
    """Return the numbers, from 1 on, of the operations that are to fail one after the other.

    These are all, except writes between other writes of a file: of them, the middle one stands for
    all, because files are written in small parts by one loop (tests/coefficients/test_files.py).
    """
    found = []
    for name, run_of_one in itertools.groupby(enumerate(operations, 1), lambda each: each[1]):
        numbers = [number for number, _ in run_of_one]
        some = {numbers[0], numbers[len(numbers) // 2], numbers[-1]}
        found += sorted(some) if name == "write" else numbers
    return found


@pytest.mark.parametrize(
    "name", [pytest.param(x, marks=pytest.mark.slow) if x in SLOW else x for x in COMMANDS]
)
def test_a_save_that_fails_anywhere_leaves_whole_files_and_is_done_by_the_next_run(
    name, at_once, capsys, monkeypatch
):
    command, written = COMMANDS[name]
    counted = Faulty()
    monkeypatch.setattr(files, "os", counted)
    assert run(capsys, *command)[0] == 0
    new = found(at_once)
    assert sorted(new) == sorted(written)
    # `new` replaces nothing; the others count again with files in their place.
    before = {} if name == "new" else dict.fromkeys(written, OLD)

    def reset() -> None:
        for each in new:
            (at_once / each).unlink(missing_ok=True)
        for each, text in before.items():
            (at_once / each).write_text(text)

    reset()
    counted.log.clear()
    run(capsys, *command)
    operations = list(counted.log)
    assert operations.count("replace") == len(written)
    assert operations.count("write") > 3 * len(written)
    for at in to_fail(operations):
        reset()
        monkeypatch.setattr(files, "os", Faulty(at))
        status, out, error = run(capsys, *command)
        assert (status, out) == (2, ""), (at, operations[at - 1])
        assert error.startswith("shadefit: ") and error.count("\n") == 1
        assert "cannot be written: Input/output error" in error
        after = found(at_once)
        assert set(after) <= set(new)
        assert all(text in (new[each], before.get(each)) for each, text in after.items())
        assert all(each in after for each in before)
    if name == "new":
        reset()
    monkeypatch.setattr(files, "os", counted)
    assert run(capsys, *command)[0] == 0
    assert found(at_once) == new


def test_the_state_of_a_search_is_whole_whichever_operation_fails(tmp_path, monkeypatch):
    entry = resolve("best/q-9")
    form, table = entry.require_fitted().form, entry.require_table()
    goal = Goal(**table.goal.model_dump())
    counted = Faulty()
    for number, outcome in enumerate((table, "it has a pole")):
        searched = Search(problem("q"), goal, tmp_path / str(number))
        monkeypatch.setattr(files, "os", counted)
        counted.log.clear()
        searched._write(form, outcome)
        (name,) = found(searched.out)
        for at in to_fail(counted.log):
            (searched.out / name).unlink(missing_ok=True)
            monkeypatch.setattr(files, "os", Faulty(at))
            with pytest.raises(ValueError, match="cannot be written"):
                searched._write(form, outcome)
            left = found(searched.out)
            # What is there counts as done; what is not is tried again.
            assert list(left) in ([], [name])
            if left and number == 0:
                assert parse(left[name], name) == table
            assert searched._refusal(form).is_file() is (number == 1 and bool(left))


def test_all_files_are_written_by_one_module():
    """So that what is tested of it holds for every command."""
    writers = {"write_text", "write_bytes", "NamedTemporaryFile", "mkstemp"}
    for package in (Path(shadefit.__file__).parent, packaged.FOLDER.parent):
        for path in package.rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.Call):
                    called = getattr(node.func, "attr", getattr(node.func, "id", ""))
                    assert called not in writers, path
                    given = [a.value for a in node.args if isinstance(a, ast.Constant)]
                    # The standard streams are opened for writing.
                    if called == "open" and path.name != "standard_streams.py":
                        assert not {"w", "wb", "a", "ab"} & set(map(str, given)), path


def test_a_table_that_is_exported_reads_back(at_once, capsys):
    assert run(capsys, *COMMANDS["export"][0])[0] == 0
    text = (at_once / "q.json").read_text()
    assert text == serialise(parse(text, "q"))
    assert json.loads(text)["name"] == "q"
