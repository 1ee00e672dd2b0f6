"""The texts that describe forms on the command line of `shadefit fit`, such as 'rational:2,2'."""

from collections.abc import Mapping
from typing import Any

# How many numbers a shape takes, at least and at most; None: one, or one for each axis.
_COUNTS: dict[str, tuple[int, int] | None] = {
    "rational": (2, 2),
    "polynomial": (1, 1),
    "chebyshev": None,
    "exponentials": (1, 2),
    "poles": (2, 2),
    "piecewise": None,
}


# A table has no more coefficients than these.
_LARGEST = 4096


def parsed_form(text: str, axes: int) -> tuple[str, list[int]]:
    """Return the shape and the numbers of a text; `axes` is how many variables the form has.

    Raises ValueError for an unknown shape, and for numbers that the shape does not take.
    """
    kind, _, numbers = text.partition(":")
    if kind not in _COUNTS:
        raise ValueError(f"--form {text}: allowed are {', '.join(_COUNTS)}, as in rational:2,2")
    try:
        counts = [int(part) for part in numbers.split(",")]
    except ValueError:
        raise ValueError(f"--form {text}: {numbers!r} are no whole numbers") from None
    least, most = _COUNTS[kind] or (1, axes)
    if not least <= len(counts) <= most or min(counts) < 0:
        allowed = str(least) if least == most else f"{least} to {most}"
        raise ValueError(f"--form {text}: allowed are {allowed} numbers after {kind}:")
    if max(counts) > _LARGEST:
        raise ValueError(f"--form {text}: allowed are numbers up to {_LARGEST}")
    return kind, counts


def form_name(text: str) -> str:
    """Return the name that a form of this text has in tables and file names."""
    return text.replace(":", "-").replace(",", "-")


def with_form(command: str, text: str, goal: Mapping[str, Any]) -> str:
    """Return the command line that fits this form with these options of the goal."""
    options = "".join(f" --{k}" if v is True else f" --{k} {v}" for k, v in goal.items())
    return f"{command} --form {text}{options}"
