"""Metal without Apple's compiler: read as C++ through a header that stands in for metal_stdlib."""

import re
from pathlib import Path

import numpy as np

from programs.function import Function
from programs.toolchains.lexical import refuse, words
from programs.toolchains.native import HALF, STRICT, evaluate_program, half_missing
from programs.toolchains.process import absent, first_line
from programs.toolchains.toolchain import refusal

NOTE = (
    "a shim: Metal has no compiler here, so g++ compiles the code against a stand-in for "
    "metal_stdlib; the values are those of the code, but Metal's own rules are not checked."
)

# What C++ takes and Metal does not.
_RULES = (
    (words(["double"]), "Metal has no double"),
    (
        re.compile(r"(?<!thread )(?<!thread const )(?<!constant )\b\w+\s*\(&"),
        "a reference needs an address space",
    ),
)
_SHIMS = Path(__file__).with_name("shims")


def absence(precision: str) -> str | None:
    """As `Toolchain.absence`."""
    if precision == "double":
        return "Metal has no double precision"
    return absent("g++", "g++") or half_missing("g++", ".cpp")


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """As `Toolchain.evaluate`."""
    refuse(source, _RULES, refusal("Metal", function, precision))
    compiler = (
        *("g++", "-std=c++17", *STRICT, *HALF),
        # In Metal a literal without a suffix is a float.
        "-fsingle-precision-constant",
        *("-isystem", _SHIMS / "metal", "-include", "metal_stdlib"),
    )
    return evaluate_program(
        "Metal", compiler, ".cpp", precision, source, function, inputs, precision
    )


def versions() -> str:
    """As `Toolchain.versions`."""
    return f"a shim header on {first_line('g++', '--version')}"
