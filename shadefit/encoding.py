"""What is printed where the output's encoding lacks a character: plain ASCII, never an error.

A terminal or a pipe may have an encoding such as cp1252, which has neither θ nor ∫. The words and
signs of `ascii_text` are written instead, and '?' for what has none.
"""

import codecs
import json
import sys
from typing import Any

# Signs of tables and of progress that `ascii_text` does not know.
_LINES = str.maketrans({"─": "-", "━": "-", "│": "|", "•": "*", "…": "..."})
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


def shown_json(text: str) -> str:
    """Return JSON text that reads back the same: characters that are lacking are escaped."""
    encoding = _encoding(sys.stdout)
    return "".join(each if has_all(each, encoding) else json.dumps(each)[1:-1] for each in text)


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
