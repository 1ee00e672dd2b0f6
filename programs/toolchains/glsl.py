"""GLSL: compiled to SPIR-V by glslang and run as a compute shader on the Vulkan device."""

import re

import numpy as np

from programs.functions import Function
from programs.languages.glsl import LANGUAGE as GLSL
from programs.languages.glsl_es import LANGUAGE as GLSL_ES
from programs.languages.spelling import Triple
from programs.toolchains import device
from programs.toolchains.interface import compile_failure
from programs.toolchains.process import execute, first_line, missing_command, workspace
from programs.toolchains.shader import STORED, main_body

NOTE = (
    "GLSL 4.50, GLSL ES 3.10; the device's inverse trigonometric functions may be off by 4e-4, its "
    "exp, log and pow by several units in the last place; GLSL has no double exp, log, pow or "
    "trigonometry."
)

_REAL = {"half": "float16_t", "float": "float", "double": "double"}
_EXTENSION = "#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require"


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    return missing_command("glslangValidator", "glslang-tools") or device.missing_reason(precision)


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    shader = compute_shader(source, function, precision)
    return _evaluate("GLSL", shader, function, inputs, precision)


def evaluate_es(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`. The code is that of GLSL ES."""
    return _evaluate("GLSL ES", compute_shader_es(source, function), function, inputs, precision)


def _evaluate(
    language: str, shader: str, function: Function, inputs: np.ndarray, precision: str
) -> np.ndarray:
    with workspace() as folder:
        (folder / "code.comp").write_text(shader, encoding="utf-8")
        execute(
            ["glslangValidator", "-V", "--target-env", "vulkan1.2", "code.comp", "-o", "code.spv"],
            failure=compile_failure(language, function, precision),
            folder=folder,
        )
        code = (folder / "code.spv").read_bytes()
    # In GLSL ES the numbers of the buffers are floats in half precision too.
    return device.evaluate(language, code, function, inputs, precision)


def missing_reason_es(precision: str) -> str | None:
    """See `Toolchain.missing_reason`. A device needs no feature for mediump."""
    if precision == "double":
        return "GLSL ES has no double precision"
    return missing_command("glslangValidator", "glslang-tools") or device.missing_reason("float")


def compute_shader_es(source: str, function: Function) -> str:
    """Write the compute shader in GLSL ES 3.10 around a function; a #version line is replaced."""
    text = re.sub(r"^[ \t]*#version\b[^\n]*", "", source, count=1, flags=re.MULTILINE)
    return f"""#version 310 es
precision highp float;
#line 1
{text}
{_main(function, "float", "float", GLSL_ES.triple("float"))}"""


def compute_shader(source: str, function: Function, precision: str) -> str:
    """Write the compute shader around a function; a #version line in `source` is replaced."""
    real, stored = _REAL[precision], STORED[precision]
    extension = f"{_EXTENSION}\n" if precision == "half" else ""
    text = re.sub(r"^[ \t]*#version\b[^\n]*", "", source, count=1, flags=re.MULTILINE)
    return f"""#version 450
{extension}#line 1
{text}
{_main(function, real, stored, GLSL.triple(precision))}"""


def _main(function: Function, real: str, stored: str, triple: Triple) -> str:
    body = main_body(function, real, stored, "shadefit_in.row", "shadefit_out.row", triple)
    return f"""layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer ShadefitIn {{ {stored} row[]; }} shadefit_in;
layout(std430, binding = 1) writeonly buffer ShadefitOut {{ {stored} row[]; }} shadefit_out;
void main() {{
    uint shadefit_k = gl_GlobalInvocationID.x;
{body}
}}
"""


def versions() -> str:
    """See `Toolchain.versions`."""
    compiler = first_line("glslangValidator", "--version").removeprefix("Glslang Version: ")
    return f"glslang {compiler}, {device.versions()}"
