"""C, C++ and languages read as C++, on this processor.

A main program around the function reads rows of inputs and writes rows of values.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from programs.functions import Function, input_names
from programs.languages.spelling import Triple
from programs.toolchains.calling import call_statements
from programs.toolchains.interface import Toolchain, compile_failure, result_count, run_failure
from programs.toolchains.process import (
    ToolchainError,
    execute,
    first_line,
    missing_command,
    workspace,
)

# Without contraction to fma and without fast-math, every operation is rounded once, as in NumPy.
# Implicit conversion of a float to a double is an error: the code would be of another precision.
STRICT = ("-O2", "-ffp-contract=off", "-Werror=double-promotion")
# Without this flag, gcc keeps half-precision values in float between operations.
HALF = ("-fexcess-precision=16",)
_REAL = {"half": "_Float16", "float": "float", "double": "double"}
# If u is half a unit in the last place of 1, then 1 + u + u = 1 if both sums are rounded to half.
HALF_PROBE = """
int main(void) {
    volatile _Float16 one = 1, u = (_Float16)0.00048828125f;
    _Float16 sum = one + u + u;
    return sum == one ? 0 : 1;
}
"""


def main_program(
    function: Function, source_file: str, real: str, triple: Triple | None = None
) -> str:
    """Write the main program, in C and C++, that reads rows from stdin and writes values to stdout.

    Arguments: `function`; `source_file`, the file with its code, which is included so that the
    compiler's messages have the line numbers of that file; `real`, the type of its numbers;
    `triple`, how vectors of three numbers are written, None for arrays.
    """
    count, width = result_count(function), len(input_names(function))
    body = call_statements(
        function, real, lambda cell: f"({real})shadefit_row[{cell}]", depth=8, triple=triple
    )
    return f"""#include "{source_file}"
#include <stdio.h>
int main(void) {{
    double shadefit_row[{width}], shadefit_out[{count}];
    while (fread(shadefit_row, sizeof(double), {width}, stdin) == {width}) {{
{body}
        for (int shadefit_i = 0; shadefit_i < {count}; ++shadefit_i)
            shadefit_out[shadefit_i] = (double)shadefit_value[shadefit_i];
        if (fwrite(shadefit_out, sizeof(double), {count}, stdout) != {count}) return 3;
    }}
    return 0;
}}
"""


def evaluate_program(
    language: str,
    compiler: Sequence[str | Path],
    suffix: str,
    real: str,
    source: str,
    function: Function,
    inputs: np.ndarray,
    precision: str,
    triple: Triple | None = None,
) -> np.ndarray:
    """Compile a function with a main program around it, and run it on all rows.

    Arguments: `language`, its name for error messages; `compiler`, a program and its flags, to
    which files and `-o` are added; `suffix` of the source files; `real`, the type of the numbers;
    `triple` as in `main_program`; the rest as in `Toolchain`. Returns (n, m) float64. Raises
    ToolchainError.
    """
    with workspace() as folder:
        (folder / f"code{suffix}").write_text(source, encoding="utf-8")
        text = main_program(function, f"code{suffix}", real, triple)
        (folder / f"main{suffix}").write_text(text, encoding="utf-8")
        execute(
            [*compiler, f"main{suffix}", "-o", "program", "-lm"],
            failure=compile_failure(language, function, precision),
            folder=folder,
        )
        failure = run_failure(language, function, precision)
        data = execute([folder / "program"], failure=failure, folder=folder, data=inputs.tobytes())
    return values_from(data, len(inputs), function, failure)


def values_from(data: bytes, rows: int, function: Function, failure: str) -> np.ndarray:
    """Read the float64 bytes that a program wrote, as (rows, results).

    Raises ToolchainError, whose message begins with `failure`, for another number of bytes.
    """
    count = result_count(function)
    if len(data) != 8 * rows * count:
        raise ToolchainError(f"{failure}: {len(data)} bytes came back, not {8 * rows * count}")
    return np.frombuffer(data, dtype=np.float64).reshape(rows, count)


@cache
def half_missing(compiler: str, suffix: str) -> str | None:
    """Return None if a C or C++ compiler rounds every half-precision operation, else the reason."""
    with workspace() as folder:
        (folder / f"probe{suffix}").write_text(HALF_PROBE, encoding="utf-8")
        try:
            execute(
                [compiler, "-O2", *HALF, f"probe{suffix}", "-o", "probe"],
                failure="probe",
                folder=folder,
            )
            execute([folder / "probe"], failure="probe", folder=folder)
        except ToolchainError:
            return f"{first_line(compiler, '--version')} has no _Float16 that rounds every step"
    return None


def _native(key: str, name: str, compiler: str, standard: str, suffix: str) -> Toolchain:
    def missing_reason(precision: str) -> str | None:
        reason = missing_command(compiler, compiler)
        if reason is None and precision == "half":
            reason = half_missing(compiler, suffix)
        return reason

    def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
        extra = HALF if precision == "half" else ()
        command = (compiler, f"-std={standard}", *STRICT, *extra)
        real = _REAL[precision]
        return evaluate_program(name, command, suffix, real, source, function, inputs, precision)

    note = (
        f"{standard.upper()}, -O2, no contraction to fma; half is _Float16, emulated with every "
        "step rounded."
    )
    return Toolchain(key, missing_reason, evaluate, lambda: first_line(compiler, "--version"), note)


C = _native("c", "C", "gcc", "c11", ".c")
CPP = _native("cpp", "C++", "g++", "c++17", ".cpp")
