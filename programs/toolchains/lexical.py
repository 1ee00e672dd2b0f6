"""What a stand-in compiler would let pass, looked for in the text itself."""

import re
from collections.abc import Iterable

from programs.toolchains.process import ToolchainError

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def without_comments(source: str) -> str:
    """Blank out comments, C's and C++'s, keeping every other character's place."""
    return _COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), source)


def refuse(source: str, rules: Iterable[tuple[re.Pattern[str], str]], failure: str) -> None:
    """Refuse a source that matches a pattern outside its comments.

    Arguments: `source`; `rules`, patterns with what is wrong where they match; `failure`, the line
    that begins the error. Raises ToolchainError with a line for every match.
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
    """Give the pattern that matches any of some words, whole."""
    return re.compile(rf"\b(?:{'|'.join(names)})\b")
