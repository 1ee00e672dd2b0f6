"""CUDA: nvcc compiles the code for device and host, and the host's code is run.

Without nvcc, g++ compiles it with a header that defines CUDA's keywords.
"""

from functools import cache
from pathlib import Path

import numpy as np

from programs.functions import Function, input_names
from programs.languages.cuda import LANGUAGE as CUDA
from programs.languages.spelling import Triple
from programs.toolchains.calling import call_statements
from programs.toolchains.interface import compile_failure, result_count, run_failure
from programs.toolchains.native import (
    STRICT,
    evaluate_program,
    main_program,
    values_from,
)
from programs.toolchains.process import (
    command_path,
    execute,
    first_line,
    missing_command,
    packaged_file,
    workspace,
)

NOTE = (
    "no GPU here: with nvcc the device code is compiled to machine code but only the host's half "
    "of the __host__ __device__ function is run (half: every step by way of float); without nvcc, "
    "a shim header and g++, which check values only."
)

_REAL = {"half": "__half", "float": "float", "double": "double"}
_SHIM = Path(__file__).with_name("shims") / "cuda.h"
# The oldest GPU that the compiler supports; device code is compiled to its machine code.
_MACHINE = "sm_75"


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    reason = missing_command("g++", "g++")
    if reason is None and precision == "half" and _compiler() is None:
        reason = "nvcc, which brings __half, is not here (PyPI: nvidia-cuda-nvcc)"
    return reason


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    compiler, real = _compiler(), _REAL[precision]
    triple = CUDA.triple(precision)
    if compiler is None:
        shim = ("g++", "-std=c++17", *STRICT, "-include", _SHIM)
        return evaluate_program(
            "CUDA", shim, ".cpp", real, source, function, inputs, precision, triple
        )
    failure = run_failure("CUDA", function, precision)
    with workspace() as folder:
        (folder / "code.cu").write_text(_with_half(source, precision), encoding="utf-8")
        text = main_program(function, "code.cu", real, triple)
        text += kernel(function, real, triple)
        (folder / "main.cu").write_text(text, encoding="utf-8")
        execute(
            [
                *(compiler, "-std=c++17", f"-arch={_MACHINE}", "-O2"),
                *("-Xcompiler", "-ffp-contract=off", *_library_flags(compiler)),
                *("main.cu", "-o", "program"),
            ],
            failure=compile_failure("CUDA", function, precision),
            folder=folder,
        )
        data = execute([folder / "program"], failure=failure, folder=folder, data=inputs.tobytes())
    return values_from(data, len(inputs), function, failure)


def kernel(function: Function, real: str, triple: Triple | None = None) -> str:
    """Write a kernel that calls the function, so that its device code is compiled completely."""
    count, width = result_count(function), len(input_names(function))
    body = call_statements(
        function,
        real,
        lambda cell: f"shadefit_in[{cell}]",
        lambda cell: f"shadefit_out[{cell}] = shadefit_value[{cell}];",
        triple=triple,
    )
    return f"""
__global__ void shadefit_kernel(const {real}* shadefit_in, {real}* shadefit_out) {{
    shadefit_in += {width} * threadIdx.x;
    shadefit_out += {count} * threadIdx.x;
{body}
}}
"""


def versions() -> str:
    """See `Toolchain.versions`."""
    host = first_line("g++", "--version")
    compiler = _compiler()
    if compiler is None:
        return f"a shim header on {host}"
    return f"{_compiler_version(compiler)} with {host}"


def _with_half(source: str, precision: str) -> str:
    included = precision != "half" or "cuda_fp16.h" in source
    return source if included else f"#include <cuda_fp16.h>\n#line 1\n{source}"


def _compiler() -> Path | None:
    return packaged_file("nvidia", "cu13/bin/nvcc") or command_path("nvcc")


def _library_flags(compiler: Path) -> tuple[str, ...]:
    # The compiler from a wheel does not search the folder in which the wheels put the libraries.
    folder = compiler.resolve().parent.parent / "lib"
    return (f"-L{folder}",) if folder.is_dir() else ()


@cache
def _compiler_version(compiler: Path) -> str:
    lines = execute([compiler, "--version"], failure="nvcc").decode().split("\n")
    release = next((line for line in lines if "release" in line), "version unknown")
    return f"nvcc {release.rpartition(', ')[2]}"
