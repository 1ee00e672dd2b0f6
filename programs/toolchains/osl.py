"""Open Shading Language: compiled and rendered by Blender, or compiled as C++ without Blender.

Blender as a Python module (bpy) is large, so it has its own command (`make toolchain-osl`). Without
it, a header gives a C++ compiler OSL's arithmetic.
"""

import re
import sys
from functools import cache
from pathlib import Path

import numpy as np

from programs.functions import Function, input_names
from programs.languages.osl import LANGUAGE as OSL
from programs.toolchains.calling import call_statements
from programs.toolchains.interface import compile_failure, result_count, run_failure
from programs.toolchains.lexical import refuse, whole_words
from programs.toolchains.native import STRICT, evaluate_program
from programs.toolchains.process import (
    ToolchainError,
    execute,
    first_line,
    missing_command,
    packaged_file,
    workspace,
)

NOTE = (
    "with bpy, OSL's own compiler and Cycles on the processor, whose exp and pow are good to 1e-5 "
    "of the value, acos and asin to 5e-5; without it a shim: g++ compiles the code against a class "
    "that guards as OSL does (x/0 is 0, roots and logarithms are clamped), and OSL's own grammar "
    "is checked only for its reserved words and literals."
)

_TRIPLE = OSL.triple("float")
_SHIM = Path(__file__).with_name("shims") / "osl.h"
_WORKER = Path(__file__).with_name("osl_worker.py")
# Seconds. Blender takes long to start, and renders three values of a function at a time.
_TIME_LIMIT = 180.0
# Words of C++ that OSL reserves or does not have
_FOREIGN = (
    *("bool", "char", "class", "const", "constexpr", "double", "enum", "inline", "long", "short"),
    *("signed", "sizeof", "static", "switch", "template", "typedef", "union", "unsigned"),
)
_SUFFIXED = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[fFhHlLuU]\b")
_RULES = ((whole_words(_FOREIGN), "no word of OSL"), (_SUFFIXED, "OSL's literals have no suffix"))


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    if precision != "float":
        return "OSL computes in float only"
    return None if renderer() else missing_command("g++", "g++")


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    failure = compile_failure("OSL", function, precision)
    # Newer OSL compilers accept a suffix that older ones refuse, so it is always refused here.
    refuse(source, _RULES, failure)
    if renderer():
        return _rendered(source, function, inputs, failure)
    compiler = ("g++", "-std=c++17", *STRICT, "-fsingle-precision-constant", "-include", _SHIM)
    return evaluate_program(
        "OSL", compiler, ".cpp", "float", source, function, inputs, precision, _TRIPLE
    )


def versions() -> str:
    """See `Toolchain.versions`."""
    return renderer() or f"a shim header on {first_line('g++', '--version')}"


@cache
def renderer() -> str | None:
    """Return the versions of Blender and its OSL, or None if Blender is absent or does not load."""
    if packaged_file("bpy", "__init__.so") is None:
        return None
    try:
        said = execute([sys.executable, "-I", _WORKER, "--version"], failure="bpy").decode()
    except ToolchainError:
        return None
    return said.strip().split("\n")[-1]  # Blender prints other lines before it


def probe(function: Function, first: int, folder: Path) -> str:
    """Write the shader that emits three values of a function, from number `first`, as a colour.

    Each pixel is one row. Textures in `folder`, with three columns each, hold the inputs.
    """
    count, width = result_count(function), len(input_names(function))
    textures = "\n".join(
        f'    color shadefit_in{index} = texture("{folder}/in{index}.exr", '
        'shadefit_s, shadefit_t, 0.0, 0.0, 0.0, 0.0, "interp", "closest");'
        for index in range(-(-width // 3))
    )
    body = call_statements(
        function, "float", lambda cell: f"shadefit_in{cell // 3}[{cell % 3}]", triple=_TRIPLE
    )
    shown = ", ".join(
        f"shadefit_value[{cell}]" if cell < count else "0.0" for cell in range(first, first + 3)
    )
    return f"""#include "code.osl"
shader probe{first}(float columns = 1.0, float rows = 1.0, output closure color Out = 0) {{
    float shadefit_s = (floor(P[0]) + 0.5) / columns;
    float shadefit_t = 1.0 - (floor(P[1]) + 0.5) / rows;
{textures}
{body}
    Out = color({shown}) * emission();
}}
"""


def _rendered(source: str, function: Function, inputs: np.ndarray, failure: str) -> np.ndarray:
    count, rows = result_count(function), len(inputs)
    firsts = [str(first) for first in range(0, count, 3)]
    worker = [sys.executable, "-I", _WORKER]
    with workspace() as folder:
        (folder / "code.osl").write_text(source, encoding="utf-8")
        for first in firsts:
            shader = probe(function, int(first), folder)
            (folder / f"probe{first}.osl").write_text(shader, encoding="utf-8")
        (folder / "inputs").write_bytes(inputs.astype(np.float32).tobytes())
        execute([*worker, "compile", *firsts], failure=failure, folder=folder)
        failure = run_failure("OSL", function, "float")
        size = (str(rows), str(inputs.shape[1]))
        execute(
            [*worker, "render", *size, *firsts],
            failure=failure,
            folder=folder,
            seconds=_TIME_LIMIT,
        )
        parts = [
            np.fromfile(folder / f"values{first}", np.float32).reshape(-1, 4)[:rows, :3]
            for first in firsts
        ]
    return np.concatenate(parts, 1)[:, :count].astype(np.float64)
