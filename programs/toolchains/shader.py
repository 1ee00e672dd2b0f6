"""Compute shaders around a function, in languages that look like C."""

from programs.functions import Function, input_names
from programs.languages.hlsl import LANGUAGE as HLSL
from programs.languages.spelling import Triple
from programs.toolchains.calling import call_statements
from programs.toolchains.interface import result_count

# Precision -> type in the buffers. Floats hold halves exactly, so no 16-bit storage is needed.
STORED = {"half": "float", "float": "float", "double": "double"}


def main_body(
    function: Function, real: str, stored: str, inputs: str, outputs: str, triple: Triple
) -> str:
    """Write the statements that call a function for row number `shadefit_k`.

    Arguments: `function`; `real`, the type that it computes in; `stored`, the type of the numbers
    in the buffers; `inputs` and `outputs`, the expressions for the buffers; `triple`, how vectors
    of three numbers are written.
    """
    count, width = result_count(function), len(input_names(function))
    return call_statements(
        function,
        real,
        lambda cell: f"{real}({inputs}[{width}u * shadefit_k + {cell}u])",
        lambda cell: (
            f"{outputs}[{count}u * shadefit_k + {cell}u] = {stored}(shadefit_value[{cell}]);"
        ),
        triple=triple,
    )


def hlsl_shader(source: str, function: Function, precision: str) -> str:
    """Write the compute shader around a function in HLSL, which Slang compiles too."""
    stored = STORED[precision]
    triple = HLSL.triple(precision)
    body = main_body(function, precision, stored, "shadefit_in", "shadefit_out", triple)
    return f"""{source}
[[vk::binding(0, 0)]] StructuredBuffer<{stored}> shadefit_in;
[[vk::binding(1, 0)]] RWStructuredBuffer<{stored}> shadefit_out;
[numthreads(64, 1, 1)]
void main(uint3 shadefit_id : SV_DispatchThreadID) {{
    uint shadefit_k = shadefit_id.x;
{body}
}}
"""
