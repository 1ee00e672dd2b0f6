"""The code that a host of shaders calls: blocks of lines after the exported functions of tables."""

import json
from collections.abc import Sequence

from programs import Function, Parameter
from programs.printing.identifiers import ascii_text, free_name

# The exported functions of each table, in the order of their calls
Tables = Sequence[tuple[Function, ...]]


def decimal(value: float) -> str:
    """Write a number with seven digits and a point or an exponent, as shaders need it."""
    text = f"{float(value):.7g}"
    return text if "." in text or "e" in text else f"{text}.0"


def middle(parameter: Parameter) -> float:
    """Return the middle of an argument's domain."""
    low, high = parameter.domain
    return (low + high) / 2


def label_of(parameter: Parameter) -> str:
    """Return the name of an argument and its unit, in ASCII, for a user interface."""
    unit = "" if parameter.unit == "1" else f" ({ascii_text(parameter.unit)})"
    return f"{parameter.name}{unit}"


def arguments_of(functions: tuple[Function, ...]) -> list[Parameter]:
    """Return the scalar arguments of all functions, in the order of the calls."""
    return [p for function in functions for p in function.parameters if p.size is None]


def call_of(functions: tuple[Function, ...]) -> str:
    """Write the value of a table as one expression of the names of its arguments."""
    text = ""
    for function in functions:
        scalars = [parameter.name for parameter in function.parameters if parameter.size is None]
        text = f"{function.name}({', '.join([*([text] if text else []), *scalars])})"
    return text


def unity(tables: Tables) -> list[list[str]]:
    """Write, for each table, functions of float and of half whose last argument is the result."""
    blocks = []
    for functions in tables:
        name = functions[-1].name
        blocks.append(
            [f"// For a Custom Function node of Shader Graph: Type = File, Name = {name}."]
        )
        for real in ("float", "half"):
            given = ", ".join(f"{real} {each.name}" for each in arguments_of(functions))
            out = free_name("Out", _names(functions))
            blocks[-1] += [
                f"void {name}_{real}({given}, out {real} {out})",
                "{",
                f"    {out} = {call_of(functions)};",
                "}",
            ]
    return blocks


def unreal(tables: Tables) -> list[list[str]]:
    """Write, for each table, one function of its arguments that returns the value."""
    blocks = []
    for functions in tables:
        name, arguments = f"{functions[-1].name}At", arguments_of(functions)
        names = ", ".join(each.name for each in arguments)
        given = ", ".join(f"float {each.name}" for each in arguments)
        blocks.append(
            [
                "// For a Custom node: add this file to its Include File Paths. Its Code is",
                f"//   return {name}({names});",
                f"float {name}({given})",
                "{",
                f"    return {call_of(functions)};",
                "}",
            ]
        )
    return blocks


def shadertoy(tables: Tables) -> list[list[str]]:
    """Draw each table in a column of its own.

    The first argument runs from left to right over its domain and the last one upwards. The others
    have the middle of their domains. A function of one argument is drawn as a curve.
    """
    columns = []
    names = [name for functions in tables for name in _names(functions)]
    x, y, column, value = (free_name(each, names) for each in ("x", "y", "column", "value"))
    for index, functions in enumerate(tables):
        arguments = arguments_of(functions)
        lines = [f"    {'if' if index == 0 else 'else if'} ({column} == {index})", "    {"]
        for place, each in enumerate(arguments):
            low, high = map(decimal, each.domain)
            part = x if place == 0 else y if place == len(arguments) - 1 else "0.5"
            lines.append(f"        highp float {each.name} = mix({low}, {high}, {part});")
        lines.append(f"        {value} = {call_of(functions)};")
        if len(arguments) == 1:
            lines.append(f"        {value} = {y} < {value} ? 1.0 : 0.2;")
        columns += [*lines, "    }"]
    return [
        [
            "void mainImage(out highp vec4 fragColor, in highp vec2 fragCoord)",
            "{",
            f"    highp float {x} = {len(tables)}.0 * fragCoord.x / iResolution.x;",
            f"    highp float {y} = fragCoord.y / iResolution.y;",
            f"    int {column} = int(floor({x}));",
            f"    {x} -= floor({x});",
            f"    highp float {value} = 0.0;",
            *columns,
            f"    fragColor = vec4(vec3({value}), 1.0);",
            "}",
        ]
    ]


def blender_shader(tables: Tables) -> list[list[str]]:
    """Write the shader of one table, whose arguments have the middle of their domains by default.

    A file of OSL has one shader. Its name is the function's name and `Node`, its output `Value`.
    """
    (functions,) = tables
    given = arguments_of(functions)
    value = free_name("Value", _names(functions))
    lines = []
    for each in given:
        low, high = map(decimal, each.domain)
        lines += [
            f"    float {each.name} = {decimal(middle(each))}",
            f"        [[ string label = {json.dumps(label_of(each))}, float min = {low}, "
            f"float max = {high} ]],",
        ]
    return [
        [
            f"shader {functions[-1].name}Node(",
            *lines,
            f"    output float {value} = 0.0)",
            "{",
            f"    {value} = {call_of(functions)};",
            "}",
        ]
    ]


def height_name(functions: tuple[Function, ...]) -> str:
    """Return the name of the ISF input that is the value at the upper edge of the picture."""
    return free_name("top", _names(functions))


def isf(tables: Tables) -> list[list[str]]:
    """Draw one table as a curve over the domain of its last argument; the others are inputs."""
    (functions,) = tables
    last = arguments_of(functions)[-1]
    low, high = map(decimal, last.domain)
    value, top = free_name("value", _names(functions)), height_name(functions)
    shade = free_name("shade", [*_names(functions), value, top])
    return [
        [
            "void main()",
            "{",
            f"    float {last.name} = mix({low}, {high}, isf_FragNormCoord.x);",
            f"    float {value} = {call_of(functions)};",
            f"    float {shade} = isf_FragNormCoord.y * {top} < {value} ? 1.0 : 0.2;",
            f"    gl_FragColor = vec4(vec3({shade}), 1.0);",
            "}",
        ]
    ]


def _names(functions: tuple[Function, ...]) -> list[str]:
    given = [each.name for each in arguments_of(functions)]
    return [*given, *(each.name for each in functions)]
