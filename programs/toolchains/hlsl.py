"""HLSL: compiled to SPIR-V by DXC, or by glslang without it, and run on the Vulkan device."""

import sys
from functools import cache
from pathlib import Path
from platform import machine

import numpy as np

from programs.functions import Function
from programs.toolchains import device
from programs.toolchains.interface import compile_failure
from programs.toolchains.process import (
    ToolchainError,
    execute,
    first_line,
    missing_command,
    packaged_file,
    workspace,
)
from programs.toolchains.shader import hlsl_shader

NOTE = (
    "shader model 6.2 with 16-bit types, to SPIR-V, not DXIL; the device's inverse trigonometric "
    "functions may be off by 4e-4, its exp, log and pow by several units in the last place; HLSL "
    "has no double intrinsics."
)

_FLAGS = ("-E", "main", "-T", "cs_6_2", "-HV", "2021", "-enable-16bit-types", "-spirv")
_DXC_FLAGS = (*_FLAGS, "-fspv-target-env=vulkan1.2")


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    if _library() is None:
        if precision == "half":
            return "DXC, the compiler with 16-bit types, is not installed (PyPI: compushady-lrtu)"
        reason = missing_command("glslangValidator", "glslang-tools")
        if reason is not None:
            return f"neither DXC (PyPI: compushady-lrtu) nor glslang: {reason}"
    return device.missing_reason(precision)


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    text = hlsl_shader(source, function, precision)
    library = _library()
    compiled = _by_glslang if library is None else _by_dxc
    code = compiled(text, compile_failure("HLSL", function, precision))
    return device.evaluate("HLSL", code, function, inputs, precision)


def versions() -> str:
    """See `Toolchain.versions`."""
    if _library() is None:
        compiler = f"{first_line('glslangValidator', '--version')}"
    else:
        compiler = _dxc_version()
    return f"{compiler}, {device.versions()}"


def _library() -> Path | None:
    """Return the path of DXC's library, or None; nothing else of the package is used."""
    return packaged_file("compushady", f"backends/libdxcompiler_{machine()}.so")


def _dxc(*arguments: str | Path) -> list[str | Path]:
    # It runs in its own process: its LLVM would conflict with another one in this process.
    script = Path(__file__).with_name("dxc_worker.py")
    return [sys.executable, "-I", script, *arguments]


def _by_dxc(text: str, failure: str) -> bytes:
    library = _library()
    assert library is not None
    with workspace() as folder:
        command = _dxc(library, *_DXC_FLAGS)
        return execute(command, failure=failure, folder=folder, data=text.encode())


def _by_glslang(text: str, failure: str) -> bytes:
    with workspace() as folder:
        (folder / "code.comp").write_text(text, encoding="utf-8")
        flags = ("-D", "-V", "-e", "main", "-S", "comp", "--target-env", "vulkan1.2")
        execute(
            ["glslangValidator", *flags, "code.comp", "-o", "code.spv"],
            failure=failure,
            folder=folder,
        )
        return (folder / "code.spv").read_bytes()


@cache
def _dxc_version() -> str:
    library = _library()
    assert library is not None
    try:
        return execute(_dxc(library, "--version"), failure="DXC").decode().strip()
    except ToolchainError as error:
        return error.summary
