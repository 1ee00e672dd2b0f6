"""Open Shading Language: read as C++ through a header that gives OSL's arithmetic."""

import re
from pathlib import Path

import numpy as np

from coefficients.function import Function
from coefficients.toolchains.lexical import refuse, words
from coefficients.toolchains.native import STRICT, evaluate_program
from coefficients.toolchains.process import absent, first_line
from coefficients.toolchains.toolchain import refusal

NOTE = (
    "a shim: no OSL compiler here, so g++ compiles the code against a class that computes as OSL "
    "does (x/0 is 0, roots and logarithms are guarded); OSL's own grammar is checked only for its "
    "reserved words and literals."
)

_SHIM = Path(__file__).with_name("shims") / "osl.h"
# What C++ knows and OSL reserves or does not know.
_FOREIGN = (
    *("bool", "char", "class", "const", "constexpr", "double", "enum", "inline", "long", "short"),
    *("signed", "sizeof", "static", "switch", "template", "typedef", "union", "unsigned"),
)
_SUFFIXED = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[fFhHlLuU]\b")
_RULES = ((words(_FOREIGN), "no word of OSL"), (_SUFFIXED, "OSL's literals have no suffix"))


def absence(precision: str) -> str | None:
    """As `Toolchain.absence`."""
    if precision != "float":
        return "OSL computes in float only"
    return absent("g++", "g++")


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """As `Toolchain.evaluate`."""
    refuse(source, _RULES, refusal("OSL", function, precision))
    compiler = ("g++", "-std=c++17", *STRICT, "-fsingle-precision-constant", "-include", _SHIM)
    return evaluate_program("OSL", compiler, ".cpp", "float", source, function, inputs, precision)


def versions() -> str:
    """As `Toolchain.versions`."""
    return f"a shim header on {first_line('g++', '--version')}"
