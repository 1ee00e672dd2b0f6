"""Statements that call a function for one row of numbers, in languages that look like C."""

from collections.abc import Callable
from dataclasses import replace
from textwrap import indent

from programs.functions import Function
from programs.languages.spelling import Triple
from programs.toolchains.interface import result_count


def call_statements(
    function: Function,
    real: str,
    number: Callable[[int], str],
    store: Callable[[int], str] | None = None,
    *,
    depth: int = 4,
    scalar: str = "{real} {name};",
    array: str = "{real} {name}[{size}];",
    given: str = "shadefit_value",
    triple: Triple | None = None,
) -> str:
    """Write statements that split a row into arguments, call the function and store the results.

    Arguments: `function`; `real`, the type of the numbers; `number(column)`, the expression for one
    number of the row; `store(index)`, the statement that stores the result
    `shadefit_value[index]`, or None to leave the results in that array; `depth`, spaces of
    indentation; `scalar` and `array`, templates of declarations of variables; `given`, the
    expression that passes the array of results to the function; `triple`, how vectors of three
    numbers are written, None for arrays of numbers. Returns lines of code.
    """
    three = triple or Triple()
    lines, arguments, column = [], [], 0
    for index, parameter in enumerate(function.parameters):
        name, size = f"shadefit_{index}", parameter.size
        if parameter.record is not None and size is not None:
            lines.append(scalar.format(real=parameter.record.name, name=name))
            places = [f"{name}.{parameter.record.place(cell)}" for cell in range(size)]
        else:
            kind, extent = real, None if size is None else str(size)
            if size is not None and parameter.shape != "array":
                count = size // 3 if parameter.shape == "vectors" else None
                kind, extent = three.type_and_extent(real, count)
            declared = scalar if extent is None else array
            lines.append(declared.format(real=kind, name=name, size=extent))
            places = replace(parameter, name=name).places(three.component)
        lines += [f"{place} = {number(cell)};" for cell, place in enumerate(places, column)]
        arguments.append(name)
        column += len(places)
    count = result_count(function)
    lines.append(array.format(real=real, name="shadefit_value", size=count))
    called = f"{function.name}({', '.join(arguments)});"
    if function.record is not None:
        lines.append(scalar.format(real=function.record.name, name="shadefit_record"))
        lines.append(f"shadefit_record = {called}")
        lines += [
            f"shadefit_value[{cell}] = shadefit_record.{place};"
            for cell, place in enumerate(
                function.record.place(cell, three.component) for cell in range(count)
            )
        ]
    elif function.result is None:
        lines.append(f"shadefit_value[0] = {called}")
    else:
        lines.append(f"{function.name}({', '.join([*arguments, given])});")
    lines += [] if store is None else [store(cell) for cell in range(count)]
    return indent("\n".join(lines), " " * depth)
