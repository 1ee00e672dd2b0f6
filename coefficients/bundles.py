"""Ready files for programs that host shaders: exported code with the entry points that they call.

* "shadertoy": an image shader for Shadertoy, which draws the function.
* "unity": an include for Custom Function nodes of Unity's Shader Graph.
* "unreal": an include for Custom nodes of Unreal's material editor.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from programs import Function, Parameter

Kind = Literal["shadertoy", "unity", "unreal"]


@dataclass(frozen=True)
class Bundle:
    """A kind of bundle: its language, and the code after the functions of each table.

    `code` maps the functions of all tables, in the order of their calls, to blocks of lines.
    """

    language: str
    code: Callable[[Sequence[tuple[Function, ...]]], list[list[str]]]


def bundle(kind: str) -> Bundle:
    """Return a kind of bundle. Raises ValueError for a kind that is not known."""
    if kind not in BUNDLES:
        raise ValueError(f"bundle {kind!r} is unknown; allowed: {', '.join(BUNDLES)}")
    return BUNDLES[kind]


def language_of_bundle(kind: str) -> str:
    """Return the key of the language of a kind of bundle. Raises ValueError as `bundle` does."""
    return bundle(kind).language


def _arguments(functions: tuple[Function, ...]) -> list[Parameter]:
    """Return the scalar arguments of all functions, in the order of the calls."""
    return [p for function in functions for p in function.parameters if p.size is None]


def _call(functions: tuple[Function, ...]) -> str:
    """Write the value of a table as one expression of the names of its arguments."""
    text = ""
    for function in functions:
        scalars = [parameter.name for parameter in function.parameters if parameter.size is None]
        text = f"{function.name}({', '.join([*([text] if text else []), *scalars])})"
    return text


def _unity(tables: Sequence[tuple[Function, ...]]) -> list[list[str]]:
    blocks = []
    for functions in tables:
        name = functions[-1].name
        blocks.append(
            [f"// For a Custom Function node of Shader Graph: Type = File, Name = {name}."]
        )
        for real in ("float", "half"):
            given = ", ".join(f"{real} {each.name}" for each in _arguments(functions))
            blocks[-1] += [
                f"void {name}_{real}({given}, out {real} Out)",
                "{",
                f"    Out = {_call(functions)};",
                "}",
            ]
    return blocks


def _unreal(tables: Sequence[tuple[Function, ...]]) -> list[list[str]]:
    blocks = []
    for functions in tables:
        name, arguments = f"{functions[-1].name}At", _arguments(functions)
        names = ", ".join(each.name for each in arguments)
        given = ", ".join(f"float {each.name}" for each in arguments)
        blocks.append(
            [
                "// For a Custom node: add this file to its Include File Paths. Its Code is",
                f"//   return {name}({names});",
                f"float {name}({given})",
                "{",
                f"    return {_call(functions)};",
                "}",
            ]
        )
    return blocks


def _shadertoy(tables: Sequence[tuple[Function, ...]]) -> list[list[str]]:
    """Draw each table in a column of its own.

    The first argument runs from left to right over its domain and the last one upwards. The others
    have the middle of their domains. A function of one argument is drawn as a curve.
    """
    columns = []
    for index, functions in enumerate(tables):
        arguments = _arguments(functions)
        lines = [f"    {'if' if index == 0 else 'else if'} (column == {index})", "    {"]
        for place, each in enumerate(arguments):
            low, high = (f"{float(end):.7g}" for end in each.domain)
            low, high = (
                text if "." in text or "e" in text else f"{text}.0" for text in (low, high)
            )
            part = "x" if place == 0 else "y" if place == len(arguments) - 1 else "0.5"
            lines.append(f"        highp float {each.name} = mix({low}, {high}, {part});")
        lines.append(f"        value = {_call(functions)};")
        if len(arguments) == 1:
            lines.append("        value = y < value ? 1.0 : 0.2;")
        columns += [*lines, "    }"]
    return [
        [
            "void mainImage(out highp vec4 fragColor, in highp vec2 fragCoord)",
            "{",
            f"    highp float x = {len(tables)}.0 * fragCoord.x / iResolution.x;",
            "    highp float y = fragCoord.y / iResolution.y;",
            "    int column = int(floor(x));",
            "    x -= floor(x);",
            "    highp float value = 0.0;",
            *columns,
            "    fragColor = vec4(vec3(value), 1.0);",
            "}",
        ]
    ]


BUNDLES: dict[str, Bundle] = {
    "shadertoy": Bundle("glsl-es", _shadertoy),
    "unity": Bundle("hlsl", _unity),
    "unreal": Bundle("hlsl", _unreal),
}
