"""A compute shader around a function, in the languages that look like C."""

from coefficients.toolchains.toolchain import result_count
from programs.function import Function, input_names

# Halves travel as floats, which hold them exactly, so that no 16-bit storage is needed.
STORED = {"half": "float", "float": "float", "double": "double"}


def main_body(function: Function, real: str, stored: str, inputs: str, outputs: str) -> str:
    """Write the statements that call a function for row `shadefit_k`.

    Arguments: `function`; `real` and `stored`, the spellings of the number type computed in and
    of the one in the buffers; `inputs` and `outputs`, the expressions that name the buffers.
    """
    count, width = result_count(function), len(input_names(function))
    lines, arguments, column = [], [], 0
    for index, parameter in enumerate(function.parameters):
        name = f"shadefit_{index}"
        size = parameter.size
        lines.append(f"    {real} {name}{'' if size is None else f'[{size}]'};")
        for cell in range(size or 1):
            place = name if size is None else f"{name}[{cell}]"
            number = f"{inputs}[{width}u * shadefit_k + {column}u]"
            lines.append(f"    {place} = {real}({number});")
            column += 1
        arguments.append(name)
    lines.append(f"    {real} shadefit_value[{count}];")
    if function.result is None:
        lines.append(f"    shadefit_value[0] = {function.name}({', '.join(arguments)});")
    else:
        arguments.append("shadefit_value")
        lines.append(f"    {function.name}({', '.join(arguments)});")
    for cell in range(count):
        place = f"{outputs}[{count}u * shadefit_k + {cell}u]"
        lines.append(f"    {place} = {stored}(shadefit_value[{cell}]);")
    return "\n".join(lines)


def hlsl_shader(source: str, function: Function, precision: str) -> str:
    """Write the compute shader around a function in HLSL, which Slang reads as well."""
    stored = STORED[precision]
    body = main_body(function, precision, stored, "shadefit_in", "shadefit_out")
    return f"""{source}
[[vk::binding(0, 0)]] StructuredBuffer<{stored}> shadefit_in;
[[vk::binding(1, 0)]] RWStructuredBuffer<{stored}> shadefit_out;
[numthreads(64, 1, 1)]
void main(uint3 shadefit_id : SV_DispatchThreadID) {{
    uint shadefit_k = shadefit_id.x;
{body}
}}
"""
