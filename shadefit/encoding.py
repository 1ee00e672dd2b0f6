"""What is printed where the output's encoding lacks a character: plain ASCII, never an error.

A terminal or a pipe may have an encoding such as cp1252, which has neither θ nor ∫. The words and
signs of `ascii_text` are written instead, and '?' for what has none.
"""

import codecs
import json
import sys
import unicodedata
from typing import Any

# Signs of tables and of progress that `ascii_text` does not know.
_LINES = str.maketrans({"─": "-", "━": "-", "│": "|", "•": "*", "…": "..."})
# General categories of characters that steer a terminal or are not seen: control codes, changes of
# the direction of writing, halves of characters, and breaks of lines.
_HIDDEN = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")
_HANDLER = "shadefit-ascii"


def install() -> None:
    """Let standard output and standard error replace the characters that their encoding lacks."""
    codecs.register_error(_HANDLER, _replacement)
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors=_HANDLER)


def shown(text: str, encoding: str | None = None) -> str:
    """Return text as it will be shown in an encoding, by default that of standard output."""
    encoding = encoding or _encoding(sys.stdout)
    codecs.register_error(_HANDLER, _replacement)
    return text.encode(encoding, _HANDLER).decode(encoding)


def visible(text: str) -> str:
    r"""Return text in which hidden characters are written as in Python, \x1b; line breaks stay.

    Names of files may have such characters, and would steer the terminal or seem to be others.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        each.encode("unicode_escape").decode("ascii") if _is_hidden(each) else each for each in text
    )


def shown_json(text: str) -> str:
    """Return JSON text that reads back the same: hidden and lacking characters are escaped."""
    encoding = _encoding(sys.stdout)
    return "".join(
        json.dumps(each)[1:-1] if _is_hidden(each) or not has_all(each, encoding) else each
        for each in text
    )


def _is_hidden(character: str) -> bool:
    return (
        not character.isprintable()
        and character != "\n"
        and unicodedata.category(character) in _HIDDEN
    )


def has_all(text: str, encoding: str | None) -> bool:
    """Return whether an encoding has all characters of a text; None stands for UTF-8."""
    try:
        text.encode(encoding or "utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _encoding(stream: Any) -> str:
    # A stream that is no file may have none.
    return getattr(stream, "encoding", None) or "utf-8"


def _replacement(error: UnicodeError) -> tuple[str, int]:
    from programs.printing.identifiers import ascii_text  # noqa: PLC0415

    if not isinstance(error, UnicodeEncodeError):
        raise error
    lacking = error.object[error.start : error.end].translate(_LINES)
    # The next letter is looked at too, because θf becomes theta_f.
    follower = error.object[error.end : error.end + 1]
    follower = follower if follower.isascii() and follower.isalnum() else ""
    replaced = ascii_text(lacking + follower)
    return replaced.removesuffix(follower) or "?", error.end
