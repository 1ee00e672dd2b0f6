"""Writing the comments above a file and above each function."""

from collections.abc import Mapping

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


def _comment(language: Language, text: str) -> list[str]:
    # A backslash at the end of a line would make the next line of code part of the comment.
    safe = ascii_text(text).replace("\\", "/")
    return wrap_words(safe, f"{language.comment} ", f"{language.comment}   ")
