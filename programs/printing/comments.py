"""Writing the comments above a file and above each function."""

import shlex
from collections.abc import Mapping, Sequence

from programs.functions import Function
from programs.languages import Language
from programs.printing.identifiers import ascii_text
from programs.printing.line_breaking import wrap_words


def header_comment(language: Language, header: Mapping[str, str]) -> list[str]:
    """Write labels and texts as lines of comment."""
    lines = []
    for label, text in header.items():
        lines += _comment(language, f"{label}: {text}")
    return lines


def function_comment(function: Function, language: Language) -> list[str]:
    """Write the summary of a function and the domains of its scalar arguments."""
    domains = []
    for parameter in function.parameters:
        if parameter.size is not None:
            # An array holds another function's results; its domain is a rough estimate.
            continue
        low, high = (f"{bound:.6g}" for bound in parameter.domain)
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        domains.append(f"{parameter.name} in [{low}, {high}]{unit}")
    lines = _comment(language, function.summary)
    return lines + (_comment(language, ", ".join(domains) + ".") if domains else [])


def command_text(words: Sequence[str]) -> str:
    """Write a command for a comment so that a shell reads the same words if it is copied.

    Each word is first written with the characters of comments, and then quoted: another character
    that became a quote would end the quotation. So a file whose name has such characters is shown
    by another name.
    """
    return shlex.join(" ".join(_plain(word).split()) for word in words)


def command_again(text: str) -> str:
    """Write a command line of `shadefit`, which may come from a hostile file, as `command_text`.

    Other text becomes one quoted word.
    """
    try:
        words = shlex.split(text)
    except ValueError:
        words = []
    return command_text(words if words[:1] == ["shadefit"] else [text])


def _plain(text: str) -> str:
    # A backslash at the end of a line would make the next line of code part of the comment.
    return ascii_text(text).replace("\\", "/")


def _comment(language: Language, text: str) -> list[str]:
    return wrap_words(_plain(text), f"{language.comment} ", f"{language.comment}   ")
