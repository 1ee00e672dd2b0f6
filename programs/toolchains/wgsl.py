"""WGSL: compiled by naga, which is part of wgpu, and run as a compute shader on Vulkan."""

import numpy as np

from programs.functions import Function, input_names
from programs.languages.wgsl import LANGUAGE as WGSL
from programs.toolchains import device
from programs.toolchains.calling import call_statements
from programs.toolchains.interface import result_count

NOTE = (
    "the device's inverse trigonometric functions may be off by 4e-4, its exp, log and pow by "
    "several units in the last place."
)

_REAL = {"half": "f16", "float": "f32"}


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    if precision == "double":
        return "WGSL has no double precision"
    return device.missing_reason(precision)


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    code = compute_shader(source, function, precision)
    return device.evaluate("WGSL", code, function, inputs, precision)


def compute_shader(source: str, function: Function, precision: str) -> str:
    """Write the compute shader around a function."""
    real = _REAL[precision]
    count, width = result_count(function), len(input_names(function))
    body = call_statements(
        function,
        real,
        lambda cell: f"{real}(shadefit_in[{width}u * shadefit_k + {cell}u])",
        lambda cell: (
            f"shadefit_out[{count}u * shadefit_k + {cell}u] = f32(shadefit_value[{cell}]);"
        ),
        scalar="var {name}: {real};",
        array="var {name}: array<{real}, {size}>;",
        given="&shadefit_value",
        triple=WGSL.triple(precision),
    )
    # A directive must come first, and may be repeated. It is put on the first line of the source so
    # that line numbers do not change.
    head = "enable f16; " if precision == "half" else ""
    return f"""{head}{source}
@group(0) @binding(0) var<storage, read> shadefit_in: array<f32>;
@group(0) @binding(1) var<storage, read_write> shadefit_out: array<f32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) shadefit_id: vec3<u32>) {{
    let shadefit_k = shadefit_id.x;
{body}
}}
"""


def versions() -> str:
    """See `Toolchain.versions`."""
    return f"naga, {device.versions()}"
