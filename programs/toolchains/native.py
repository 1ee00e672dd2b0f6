"""C, C++ and their kin on this processor: a program around the function, rows in, values out."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from programs.functions import Function, input_names
from programs.toolchains.calling import call_statements
from programs.toolchains.process import (
    ToolchainError,
    missing_command,
    execute,
    first_line,
    workspace,
)
from programs.toolchains.interface import Toolchain, run_failure, compile_failure, result_count

# No contraction to fma and no fast-math: every operation is rounded once, as NumPy does it.
# A float that becomes a double unseen is an error: the code would not be what it says it is.
STRICT = ("-O2", "-ffp-contract=off", "-Werror=double-promotion")
# Without this, gcc keeps half precision in float between operations.
HALF = ("-fexcess-precision=16",)
_REAL = {"half": "_Float16", "float": "float", "double": "double"}
# 1 + u + u with u half a unit in the last place is 1 when every sum is rounded to half.
HALF_PROBE = """
int main(void) {
    volatile _Float16 one = 1, u = (_Float16)0.00048828125f;
    _Float16 sum = one + u + u;
    return sum == one ? 0 : 1;
}
"""


def main_program(function: Function, source_file: str, real: str) -> str:
    """Write the program (C, C++ and kin alike) that maps rows on stdin to values on stdout.

    Arguments: `function`; `source_file`, the file that holds it, included so that the compiler's
    line numbers are the file's own; `real`, the number type's spelling.
    """
    count, width = result_count(function), len(input_names(function))
    body = call_statements(function, real, lambda cell: f"({real})shadefit_row[{cell}]", depth=8)
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
) -> np.ndarray:
    """Compile a function with a main program around it and run it over all rows.

    Arguments: `language`, for error lines; `compiler`, program and flags, which takes files and
    `-o`; `suffix` of its source files; `real`, the number type's spelling; the rest as in
    `Toolchain.evaluate`. Returns (n, m) float64. Raises ToolchainError.
    """
    with workspace() as folder:
        (folder / f"code{suffix}").write_text(source, encoding="utf-8")
        text = main_program(function, f"code{suffix}", real)
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
    """Shape the float64 bytes that a program wrote as (rows, results), or say that some lack."""
    count = result_count(function)
    if len(data) != 8 * rows * count:
        raise ToolchainError(f"{failure}: {len(data)} bytes came back, not {8 * rows * count}")
    return np.frombuffer(data, dtype=np.float64).reshape(rows, count)


@cache
def half_missing(compiler: str, suffix: str) -> str | None:
    """None when a C or C++ compiler rounds every half-precision operation; else the reason."""
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


def _native(target: str, language: str, compiler: str, standard: str, suffix: str) -> Toolchain:
    def missing_reason(precision: str) -> str | None:
        reason = missing_command(compiler, compiler)
        if reason is None and precision == "half":
            reason = half_missing(compiler, suffix)
        return reason

    def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
        extra = HALF if precision == "half" else ()
        command = (compiler, f"-std={standard}", *STRICT, *extra)
        real = _REAL[precision]
        return evaluate_program(
            language, command, suffix, real, source, function, inputs, precision
        )

    note = (
        f"{standard.upper()}, -O2, no contraction to fma; half is _Float16, emulated with every "
        "step rounded."
    )
    return Toolchain(
        target, missing_reason, evaluate, lambda: first_line(compiler, "--version"), note
    )


C = _native("c", "C", "gcc", "c11", ".c")
CPP = _native("cpp", "C++", "g++", "c++17", ".cpp")
