"""C++ with g++, run as a program of this machine."""

import numpy as np

from coefficients.toolchains.native import HALF, STRICT, evaluate_program, half_missing
from coefficients.toolchains.process import absent, first_line
from programs.function import Function

NOTE = "C++17, -O2, no contraction to fma; half is _Float16, emulated with every step rounded."

_REAL = {"half": "_Float16", "float": "float", "double": "double"}


def absence(precision: str) -> str | None:
    """As `Toolchain.absence`."""
    reason = absent("g++", "g++")
    if reason is None and precision == "half":
        reason = half_missing("g++", ".cpp")
    return reason


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """As `Toolchain.evaluate`."""
    extra = HALF if precision == "half" else ()
    compiler = ("g++", "-std=c++17", *STRICT, *extra)
    real = _REAL[precision]
    return evaluate_program("C++", compiler, ".cpp", real, source, function, inputs, precision)


def versions() -> str:
    """As `Toolchain.versions`."""
    return first_line("g++", "--version")
