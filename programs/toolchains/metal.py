"""Metal without Apple's compiler: compiled as C++ with a substitute for metal_stdlib."""

import re
from pathlib import Path

import numpy as np

from programs.functions import Function
from programs.languages.metal import LANGUAGE as METAL
from programs.toolchains.interface import compile_failure
from programs.toolchains.lexical import refuse, whole_words
from programs.toolchains.native import HALF, STRICT, evaluate_program, half_missing
from programs.toolchains.process import first_line, missing_command

NOTE = (
    "a shim: Metal has no compiler here, so g++ compiles the code against a stand-in for "
    "metal_stdlib; the values are those of the code, but Metal's own rules are not checked."
)

# Patterns that C++ accepts and Metal does not, with the complaint
_RULES = (
    (whole_words(["double"]), "Metal has no double"),
    (
        re.compile(r"(?<!thread )(?<!thread const )(?<!constant )\b\w+\s*\(&"),
        "a reference needs an address space",
    ),
)
_SHIMS = Path(__file__).with_name("shims")


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    if precision == "double":
        return "Metal has no double precision"
    return missing_command("g++", "g++") or half_missing("g++", ".cpp")


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    refuse(source, _RULES, compile_failure("Metal", function, precision))
    compiler = (
        *("g++", "-std=c++17", *STRICT, *HALF),
        # In Metal a literal without a suffix is a float.
        "-fsingle-precision-constant",
        *("-isystem", _SHIMS / "metal", "-include", "metal_stdlib"),
    )
    return evaluate_program(
        "Metal",
        compiler,
        ".cpp",
        precision,
        source,
        function,
        inputs,
        precision,
        METAL.triple(precision),
    )


def versions() -> str:
    """See `Toolchain.versions`."""
    return f"a shim header on {first_line('g++', '--version')}"
