"""What the commands print: tables on a terminal, JSON, and progress on standard error."""

import json
import sys
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table as Grid


def print_json(value: Any) -> None:
    """Print one JSON object. Numbers have all digits that are needed to read them back exactly."""
    print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def print_table(title: str, columns: list[str], rows: list[list[str]], note: str = "") -> None:
    """Print a table with a note below it. The first column is left-aligned, the others right."""
    grid = Grid(title=title, title_justify="left", box=SIMPLE_HEAD, caption=note or None)
    grid.caption_justify = "left"
    for index, column in enumerate(columns):
        grid.add_column(column, justify="left" if index == 0 else "right", no_wrap=True)
    for row in rows:
        grid.add_row(*row)
    # If the output is no terminal, there is no width to fit into: the table gets enough.
    width = None if sys.stdout.isatty() else 200
    Console(highlight=False, markup=False, width=width).print(grid)


def place(where: dict[str, float]) -> str:
    """Write a point as text: 'alpha 0.15, theta_f 1.57'."""
    return ", ".join(f"{name} {value:.4g}" for name, value in where.items())


@contextmanager
def stages() -> Generator[Progress]:
    """Show on standard error what a long command is doing. Show nothing if it is no terminal."""
    console = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(
        *columns, console=console, transient=True, disable=not sys.stderr.isatty()
    ) as progress:
        yield progress
