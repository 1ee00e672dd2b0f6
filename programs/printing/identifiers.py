"""Names for the intermediate values of printed code: the author's, or ones that say what it is."""

import re
import unicodedata
from collections.abc import Collection

from programs.program import Step

# Signs that have no ASCII of their own, beside the Greek letters, which go by their names.
_SIGNS = str.maketrans(
    {
        "·": "*", "×": "x", "−": "-", "–": "-", "—": "-", "±": "+-", "½": "1/2", "≈": "~",
        "≤": "<=", "≥": ">=", "∈": "in", "∫": "int", "√": "sqrt", "∞": "inf", "∂": "d", "→": "->",
        "°": " deg", "′": "'", "’": "'", "‘": "'", "“": '"', "”": '"',
    }
)  # fmt: skip


def ascii_text(text: str) -> str:
    """Write text in printable ASCII: not every shader compiler reads more, even in comments."""
    plain = text.translate(_SIGNS)
    # θf is theta_f, not thetaf.
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
    # What is left of ö is o, of ₀ is 0 and of … is ...
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode("ascii")
    raised = unicodedata.decomposition(character).startswith("<super>")
    return f"^{plain}" if raised else plain or "?"


def as_identifier(text: str) -> str:
    """Make an identifier of a name: ASCII, no underscore in front, none doubled; may be empty."""
    word = re.sub(r"\W", "_", ascii_text(text).replace("^", ""))
    return re.sub(r"__+", "_", word).strip("_").lstrip("0123456789")


def free_name(wanted: str, taken: Collection[str]) -> str:
    """Give the wanted name, or the first of wanted_2, wanted_3, … that is not taken."""
    if wanted not in taken:
        return wanted
    stem = re.sub(r"_\d+$", "", wanted)
    number = 2
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"


# operation -> what stands before the operand's name
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


# operation -> what is said of an operand that is bounded by a constant
_BOUNDS = {"min": "AtMost", "max": "AtLeast"}


def descriptive_name(step: Step, operand_names: tuple[str | None, ...]) -> str | None:
    """Name the result of a step after its operands: alpha2, b3, sinThetaF, oneMinusAlpha, ….

    Arguments: `step`; `operand_names`, an identifier for each operand that has one, else None.
    Returns an identifier, or None where none suggests itself.
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
    return left + right if len(left) == len(right) == 1 else None


def _power(name: str) -> tuple[str, int]:
    # b3 is the third power of b, as the field writes it; a name like e1x has none.
    found = re.fullmatch(r"(.*[A-Za-z])([2-9])", name)
    return (found[1], int(found[2])) if found else (name, 1)


def _capital(name: str) -> str:
    return name[0].upper() + name[1:]
