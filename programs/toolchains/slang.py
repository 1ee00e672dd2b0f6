"""Slang: compiled to SPIR-V by slangc and run as a compute shader on the Vulkan device."""

from pathlib import Path

import numpy as np

from programs.functions import Function
from programs.toolchains import device
from programs.toolchains.interface import compile_failure
from programs.toolchains.process import command_path, execute, first_line, packaged_file, workspace
from programs.toolchains.shader import hlsl_shader

NOTE = (
    "slangc -O0 to SPIR-V; the device's inverse trigonometric functions may be off by 4e-4, its "
    "exp, log and pow by several units in the last place; no double exp, log, pow or trigonometry."
)


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    if _compiler() is None:
        return (
            "slangc is not on PATH nor in the environment (PyPI: slangtorch, without what it needs)"
        )
    return device.missing_reason(precision)


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    compiler = _compiler()
    assert compiler is not None
    with workspace() as folder:
        (folder / "code.slang").write_text(
            hlsl_shader(source, function, precision), encoding="utf-8"
        )
        # The optimizer of SPIR-V is a library that the package does not contain, hence -O0.
        flags = ("-target", "spirv", "-O0", "-entry", "main", "-stage", "compute")
        execute(
            [compiler, "code.slang", *flags, "-o", "code.spv"],
            failure=compile_failure("Slang", function, precision),
            folder=folder,
        )
        code = (folder / "code.spv").read_bytes()
    return device.evaluate("Slang", code, function, inputs, precision)


def versions() -> str:
    """See `Toolchain.versions`."""
    compiler = _compiler()
    name = "no slangc" if compiler is None else f"slangc {first_line(compiler, '-v')}"
    return f"{name}, {device.versions()}"


def _compiler() -> Path | None:
    return command_path("slangc") or packaged_file("slangtorch", "bin/slangc")
