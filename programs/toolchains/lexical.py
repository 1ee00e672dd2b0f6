"""Checks of source text for what the language forbids but a substitute compiler accepts."""

import re
from collections.abc import Iterable

from programs.toolchains.process import ToolchainError

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def without_comments(source: str) -> str:
    """Replace comments of C and C++ by spaces, so that all other characters keep their places."""
    return _COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), source)


def refuse(source: str, rules: Iterable[tuple[re.Pattern[str], str]], failure: str) -> None:
    """Refuse source code that matches a pattern outside its comments.

    Arguments: `source`; `rules`, pairs of a pattern and the complaint where it matches; `failure`,
    the first line of the error. Raises ToolchainError with one line for every match.
    """
    text = without_comments(source)
    complaints = [
        f"line {text.count(chr(10), 0, found.start()) + 1}: {complaint}: {found[0].strip()!r}"
        for pattern, complaint in rules
        for found in pattern.finditer(text)
    ]
    if complaints:
        raise ToolchainError(failure, "\n".join(complaints))


def whole_words(names: Iterable[str]) -> re.Pattern[str]:
    """Return the pattern that matches any of these names as a whole word."""
    return re.compile(rf"\b(?:{'|'.join(names)})\b")
