"""The packaged tables: their names, their files, and their content. This module needs no JAX.

`coefficients.catalogue` adds what a table is for: its quantity, its form and its functions.
"""

import os
import tomllib
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Literal

from coefficients.table import Table, read

FOLDER = Path(__file__).parent / "tables"
# The project's name in its project file
NAME = "shadefit"
# Behind the name of a published table: the table as it is printed, without corrections.
AS_PRINTED = "@printed"
EXACT = "exact"
# The first part of the names of ambient functions, which use tables
AMBIENT = "ambient"
# The first parts of the names of functions that are exported, but not fitted.
FUNCTIONS = ("sampler", "decode", "detail", "curvature", AMBIENT)

Kind = Literal["printed", "published", "refitted", "best", "exact", "file"]
_KINDS: dict[str, Kind] = {"published": "published", "refit": "refitted", "best": "best"}


def in_checkout() -> bool:
    """Return whether the packaged tables are those of a checkout, which may be replaced.

    Other packages leave their project files among the installed ones, so that its name counts.
    """
    root = FOLDER.parent.parent
    if root.name in ("site-packages", "dist-packages"):
        return False
    try:
        return (
            tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]["name"] == NAME
        )
    except (OSError, ValueError, KeyError, TypeError):
        return False


@lru_cache(maxsize=1)
def files() -> dict[str, Path]:
    """Map the names of the packaged tables to their files: refitted, best, then published."""
    found: dict[str, Path] = {}
    for folder, prefix in (("refit", ""), ("best", "best/"), ("published", "published/")):
        paths = sorted(FOLDER.glob(f"*/{folder}/*.json"), key=lambda path: path.name)
        found |= {f"{prefix}{path.stem}": path for path in paths}
    return found


@lru_cache(maxsize=1)
def names() -> tuple[str, ...]:
    """List the names of the packaged tables: refitted, best, published, and as printed."""
    known = list(files())
    printed = [
        f"{name}{AS_PRINTED}"
        for name in known
        if name.startswith("published/") and corrected(stored(name)) != stored(name)
    ]
    return (*known, *printed)


def names_of_best() -> list[str]:
    """List the names of the best tables, such as 'best/q-9'. Their forms are not the published."""
    return [name for name in files() if name.startswith("best/")]


def is_file(name: str) -> bool:
    """Return whether a user's name stands for a table's file."""
    # For a name that is too long, os.path.isfile returns false; Path.is_file raises an error.
    return name.endswith(".json") or os.path.isfile(name)


def is_packaged(name: str) -> bool:
    """Return whether a name is that of a packaged table, also with '@printed' behind it."""
    return name in names() or name.removesuffix(AS_PRINTED) in files()


def unknown(name: str, quantities: Iterable[str], declared: Iterable[str] = ()) -> ValueError:
    """Return the error for a name that no table has.

    `quantities` are the names of all, `declared` those of tables that are not packaged.
    """
    every = list(quantities)
    public = [each for each in (f"published/{owner}" for owner in every) if each in files()]
    allowed = ", ".join([*every, *public, *declared, *names_of_best()])
    return ValueError(f"no table is called {name!r}: allowed are {allowed}, or a .json file's path")


def kind_of(name: str) -> Kind:
    """Return the kind of a packaged table with a name of `names`."""
    if name.endswith(AS_PRINTED):
        return "printed"
    return _KINDS[files()[name].parent.name]


def packaged_table(name: str) -> Table:
    """Return a packaged table; errata are applied except to '@printed'.

    The name is one of which `is_packaged` is true. Raises ValueError for '@printed' if the table is
    not a published one.
    """
    stem = name.removesuffix(AS_PRINTED)
    if stem != name and kind_of(stem) != "published":
        raise ValueError(f"{stem} is not published: allowed is {stem} without {AS_PRINTED}")
    return stored(stem) if stem != name else corrected(stored(stem))


@lru_cache(maxsize=256)
def stored(name: str) -> Table:
    """Return a packaged table as its file has it, without corrections."""
    return read(files()[name])


def corrected(table: Table) -> Table:
    """Return a published table with its errata applied; other tables are returned unchanged.

    An erratum that is applied loses its `exchange_rows`, so that it is not applied a second time if
    the result is written and read again.
    """
    if table.publication is None:
        return table
    rows = list(range(len(table.coefficients)))
    for erratum in table.publication.errata:
        if erratum.exchange_rows is not None:
            first, second = erratum.exchange_rows
            if not (0 <= first < len(rows) and 0 <= second < len(rows)):
                raise ValueError(f"erratum {erratum.id} exchanges rows that do not exist")
            rows[first], rows[second] = rows[second], rows[first]
    applied = [each.model_copy(update={"exchange_rows": None}) for each in table.publication.errata]
    return table.model_copy(
        update={
            "coefficients": [table.coefficients[row] for row in rows],
            "publication": table.publication.model_copy(update={"errata": applied}),
        }
    )
