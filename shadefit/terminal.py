"""What the commands print: tables on a terminal, and JSON."""

import json
import math
import shutil
import sys
from collections.abc import Generator
from contextlib import contextmanager, nullcontext, redirect_stdout
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from rich.console import Console
from rich.text import Text

from coefficients.files import is_standard_output
from shadefit.encoding import shown, shown_json, visible
from shadefit.layout import RULE, laid_out, wrapped

# Without a terminal there is no width to fit into: every table has its columns side by side.
_UNLIMITED = 10_000
# In a terminal notes are not wider than this, because long lines are hard to read.
_WIDEST_NOTE = 100
# What a number is that JSON does not have
NOT_FINITE = {"inf": "infinity", "-inf": "-infinity", "nan": "no number"}


@contextmanager
def messages_beside(*files: Path | None) -> Generator[None]:
    """Print messages to standard error if one of the files of a command is standard output."""
    beside = any(each is not None and is_standard_output(each) for each in files)
    with redirect_stdout(sys.stderr) if beside else nullcontext():
        yield


def print_lines(*lines: object) -> None:
    """Print lines that may contain names of files. Hidden characters are escaped."""
    for line in lines:
        print(visible(str(line)))


def print_json(output: BaseModel) -> None:
    """Print one JSON object. Numbers have all digits that are needed to read them back exactly.

    A number that is not finite is null, and `not_finite` says what it is.
    """
    value = output.model_dump(mode="json", by_alias=True)
    value.pop("not_finite", None)
    reasons: dict[str, str] = {}
    value = _finite(value, "", reasons)
    if reasons:
        value["not_finite"] = reasons
    print(shown_json(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)))


def _finite(value: Any, place: str, reasons: dict[str, str]) -> Any:
    """Replace numbers that are not finite by None, and add what they are to `reasons`."""
    if isinstance(value, dict):
        start = f"{place}." if place else ""
        return {key: _finite(each, f"{start}{key}", reasons) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each, f"{place}[{k}]", reasons) for k, each in enumerate(value)]
    if isinstance(value, float) and not math.isfinite(value):
        reasons[place] = NOT_FINITE[str(value)]
        return None
    return value


def print_table(
    title: str, columns: list[str], rows: list[list[str]], note: str = "", below: int = 0
) -> None:
    """Print a table with a note below it, in the width of the terminal. No number is cut.

    The lines of the note are kept, and wrapped in a terminal.
    The last `below` columns are on a line of their own under each row: 'at alpha 0.15'. In such a
    column an empty cell is left out.
    """
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else _UNLIMITED
    header, lines = laid_out(
        [_cell(each) for each in columns],
        [[_cell(each) for each in row] for row in rows],
        below,
        width,
    )
    text = [(line, "italic") for line in wrapped(_cell(title), width)]
    text += [(line, "bold") for line in header]
    if header:
        text.append((shown(RULE) * max(map(len, [*header, *lines])), "dim"))
    text += [(line, "") for line in lines]
    widest = min(width, _WIDEST_NOTE) if sys.stdout.isatty() else width
    for each in note.splitlines():
        text += [(line, "dim") for line in wrapped(_cell(each), widest)]
    console = Console(highlight=False, markup=False, soft_wrap=True)
    for line, style in text:
        console.print(Text(line, style))
    console.print()


def _cell(text: str) -> str:
    return shown(visible(text))


def place(where: dict[str, float]) -> str:
    """Write a point as text: 'alpha 0.15, theta_f 1.57'."""
    return ", ".join(f"{name} {value:.4g}" for name, value in where.items())
