"""Names of the intermediate values in printed code, and text that is safe in its comments."""

import re
import unicodedata
from collections.abc import Collection

from programs.program import Step

# Replacements for characters that are not ASCII; Greek letters are replaced by their names.
_SIGNS = str.maketrans(
    {
        "·": "*", "×": "x", "−": "-", "–": "-", "—": "-", "±": "+-", "½": "1/2", "≈": "~",
        "≤": "<=", "≥": ">=", "∈": "in", "∫": "int", "√": "sqrt", "∞": "inf", "∂": "d", "→": "->",
        "°": " deg", "′": "'", "’": "'", "‘": "'", "“": '"', "”": '"',
    }
)  # fmt: skip


def ascii_text(text: str) -> str:
    """Write text in printable ASCII; some shader compilers read nothing else, even in comments."""
    # √q becomes sqrt(q), not sqrtq.
    plain = re.sub(r"√([^\W\d⁰-⁹¹²³][^\W⁰-⁹¹²³]*)", r"√(\1)", text).translate(_SIGNS)
    # θf becomes theta_f, not thetaf.
    plain = re.sub(r"([\u0370-\u03ff])(?=[A-Za-z])", r"\1_", plain)
    return "".join(map(_ascii, plain))


def _ascii(character: str) -> str:
    if not character.isprintable():
        return " " if character.isspace() else ""
    if character.isascii():
        return character
    _, greek, letter = unicodedata.name(character, "").partition("GREEK SMALL LETTER ")
    if greek:
        return letter.replace("LAMDA", "LAMBDA").lower()
    _, greek, letter = unicodedata.name(character, "").partition("GREEK CAPITAL LETTER ")
    if greek:
        return letter.replace("LAMDA", "LAMBDA").capitalize()
    # ö becomes o, ₀ becomes 0 and … becomes ...
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode("ascii")
    raised = unicodedata.decomposition(character).startswith("<super>")
    return f"^{plain}" if raised else plain or "?"


def as_identifier(text: str) -> str:
    """Turn text into an ASCII identifier, which may be empty: no leading or double underscores."""
    # material.m[3] becomes m3, and c[3] becomes c3.
    member = re.sub(r"\[(\d+)\]", r"\1", text.partition(".")[2] or text)
    word = re.sub(r"\W", "_", ascii_text(member).replace("^", ""))
    return re.sub(r"__+", "_", word).strip("_").lstrip("0123456789")


def camel_case(name: str) -> str:
    """Write an identifier in camel case: theta_f becomes thetaF, sin2_ut becomes sin2Ut.

    An underscore before a digit stays, because the digits around it would run together.
    """
    return re.sub(r"_+([A-Za-z])", lambda found: found[1].upper(), name)


def free_name(wanted: str, taken: Collection[str]) -> str:
    """Return the wanted name, or the first of wanted_2, wanted_3, … that is not taken."""
    if wanted not in taken:
        return wanted
    stem = re.sub(r"_\d+$", "", wanted)
    number = 2
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"


# Operation -> prefix of the operand's name
_PREFIXES = {
    "abs": "abs",
    "acos": "acos",
    "asin": "asin",
    "atan": "atan",
    "cos": "cos",
    "cosh": "cosh",
    "exp": "exp",
    "exp2": "exp2",
    "floor": "floor",
    "log": "log",
    "neg": "minus",
    "rsqrt": "rsqrt",
    "sin": "sin",
    "sinh": "sinh",
    "sqrt": "sqrt",
    "tan": "tan",
    "tanh": "tanh",
}


# Operation with a constant operand -> suffix of the other operand's name
_BOUNDS = {"min": "AtMost", "max": "AtLeast"}


def descriptive_name(step: Step, operand_names: tuple[str | None, ...]) -> str | None:
    """Name the result of a step after its operands: alpha2, b3, sinThetaF, oneMinusAlpha, ….

    Arguments: `operand_names`, an identifier for each operand that has one, else None. Returns an
    identifier, or None if no name suggests itself.
    """
    names = operand_names
    if step.operation == "mul" and names[0] and names[1]:
        return _product(names[0], names[1])
    if step.operation == "add" and names[0] and names[0] == names[1]:
        return "twice" + _capital(names[0])
    if step.operation == "sub" and names[0] is None and step.operands[0] == 1.0 and names[1]:
        return "oneMinus" + _capital(names[1])
    if step.operation in _PREFIXES and names[0]:
        return _PREFIXES[step.operation] + _capital(names[0])
    if step.operation in _BOUNDS and (names[0] is None) != (names[1] is None):
        return (names[0] or names[1] or "") + _BOUNDS[step.operation]
    return None


def _product(left: str, right: str) -> str | None:
    (base, power), (other, more) = _power(left), _power(right)
    if base == other:
        return f"{base}{power + more}"
    short = all(re.fullmatch("[A-Za-z][2-9]?", name) for name in (left, right))
    return left + right if short else None


def _power(name: str) -> tuple[str, int]:
    # b3 is the third power of b. A name without a last digit from 2 to 9 is a first power.
    found = re.fullmatch(r"(.*[A-Za-z])([2-9])", name)
    return (found[1], int(found[2])) if found else (name, 1)


def _capital(name: str) -> str:
    return name[0].upper() + name[1:]
