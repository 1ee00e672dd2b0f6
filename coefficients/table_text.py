"""Text of JSON tables from files that may be hostile: errors are ValueErrors of one line."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from coefficients.input_files import read_bounded
from coefficients.json_text import read_object

T = TypeVar("T")


def read_text(path: Path, limit: int) -> str:
    """Return the text of a file of at most `limit` bytes. Raises ValueError if it has none."""
    try:
        return read_bounded(path, limit).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no UTF-8 text") from None


def validated(validate: Callable[[dict[str, Any]], T], text: str, source: str) -> T:
    """Return what `validate` makes of the JSON object in `text`.

    `validate` is a function that raises Pydantic's ValidationError. `source` is the name of the
    text in error messages. Raises ValueError with a message of one line for anything that is not
    valid.
    """
    try:
        return validate(read_object(text))
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
        # The place of an error contains keys and indices, and the types that the validator tried.
        # Only keys and indices help a reader.
        parts = [str(part) for part in first["loc"] if "[" not in str(part)]
        place = ".".join(parts) or "the table"
        message = first["msg"].removeprefix("Value error, ")
        raise ValueError(f"{source}: {_one_line(place)}: {_one_line(message)}") from None
    except RecursionError:
        raise ValueError(f"{source} is no JSON table: nested too deeply") from None
    except ValueError as error:
        raise ValueError(f"{source} is no JSON table: {_one_line(str(error))}") from None


def _one_line(text: str) -> str:
    """Shorten text and remove control codes, because it may come from a hostile file."""
    shown = " ".join("".join(c if c.isprintable() else " " for c in text[:200]).split())
    return shown if len(text) <= 200 else f"{shown}…"
