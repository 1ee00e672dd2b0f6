"""Derivatives of a program's output by all of its values, as C code in interval arithmetic.

The code is in the macros of `kernel/jets.h`, `elementary.h` and `rounding.h`. The names p5 and v5
stand for the exact and the rounded result of an operation with the number 5, and d5 for the
derivative of the output by v5.

A compiler may fuse a product and a sum, so that the product is not rounded in this sum, but it is
where it is used otherwise. So the rounding of a product that is used repeatedly is not the same
everywhere. Then s5 stands for the sum of the magnitudes of the derivatives by its uses. Processors
also fuse the negative or the size of a product, so that these count as uses of the product.
"""

from collections.abc import Callable, Sequence

from programs.program import Operand, Program, is_value

# operation -> for each operand, the derivative as a template. {d} is the derivative of the output
# by the result, {y} the result before it is rounded, {a} and {b} are the operands.
_RULES: dict[str, tuple[str, ...]] = {
    "add": ("{d}", "{d}"),
    "sub": ("{d}", "NEG({d})"),
    "mul": ("MUL({d}, {b})", "MUL({d}, {a})"),
    "div": ("DIV({d}, {b})", "NEG(DIV(MUL({d}, {y}), {b}))"),
    "neg": ("NEG({d})",),
    "abs": ("SIGNED({d}, {a})",),
    "sqrt": ("DIV({d}, MUL(2.0, {y}))",),
    "rsqrt": ("NEG(DIV(MUL({d}, {y}), MUL(2.0, {a})))",),
    "max": ("LARGER_PART({d}, {a}, {b})", "LARGER_PART({d}, {b}, {a})"),
    "min": ("SMALLER_PART({d}, {a}, {b})", "SMALLER_PART({d}, {b}, {a})"),
    "select": ("", "SELECT({t}, {d}, 0.0)", "SELECT({t}, 0.0, {d})"),
    "exp": ("MUL({d}, {y})",),
    "exp2": ("MUL({d}, MUL({y}, constant(LN2)))",),
    "expm1": ("MUL({d}, ADD({y}, 1.0))",),
    "log": ("DIV({d}, {a})",),
    "log1p": ("DIV({d}, ADD({a}, 1.0))",),
    "sin": ("MUL({d}, COS({a}))",),
    "cos": ("NEG(MUL({d}, SIN({a})))",),
    "tan": ("MUL({d}, ADD(MUL({y}, {y}), 1.0))",),
    "asin": ("DIV({d}, SQRT(SUB(1.0, MUL({a}, {a}))))",),
    "acos": ("NEG(DIV({d}, SQRT(SUB(1.0, MUL({a}, {a})))))",),
    "atan": ("DIV({d}, ADD(MUL({a}, {a}), 1.0))",),
    "sinh": ("MUL({d}, COSH({a}))",),
    "cosh": ("MUL({d}, SINH({a}))",),
    "tanh": ("MUL({d}, SUB(1.0, MUL({y}, {y})))",),
    "pow": ("DIV(MUL({d}, MUL({b}, {y})), {a})", "MUL({d}, MUL({y}, LOG({a})))"),
    "atan2": (
        "DIV(MUL({d}, {b}), ADD(MUL({a}, {a}), MUL({b}, {b})))",
        "NEG(DIV(MUL({d}, {a}), ADD(MUL({a}, {a}), MUL({b}, {b}))))",
    ),
}

# Operations that only change the sign, which is part of a fused operation
_SIGNS = ("neg", "abs")


def derivative_lines(
    program: Program, wanted: set[int], leaf: Callable[[Operand], int | None]
) -> list[str]:
    """Write the derivatives of a program's only output by the `wanted` values and by its leaves.

    `wanted` has, for each of its members, all values that are computed from it. `leaf` returns the
    number under which a constant is counted as a value, or None for a constant whose derivative is
    not asked for. Raises ValueError for an operation without a rule.
    """
    first, lines = len(program.inputs), []
    # For each value, the derivatives by its uses, and the same for the sum of magnitudes
    parts: dict[int, list[str]] = {}
    sizes: dict[int, list[str]] = {}
    separate = used_separately(program)
    (output,) = program.outputs
    if is_value(output) and output in wanted:
        parts[output], sizes[output] = ["JET(1.0)"], ["JET(1.0)"]
    for number in range(first + len(program.steps) - 1, first - 1, -1):
        if number not in wanted:
            continue
        step = program.steps[number - first]
        lines += _total(number, parts.get(number, ["JET(0.0)"]))
        if number in separate:
            lines += _magnitudes(number, sizes.get(number, []))
        if step.operation not in _RULES:
            raise ValueError(f"rounding of {step.operation!r} is not bounded")
        operands = _named(step.operands, leaf)
        names = {"d": f"d{number}", "y": f"p{number}", "t": operands[0]}
        names |= dict(zip("ab", operands, strict=False))
        for operand, rule in zip(step.operands, _RULES[step.operation], strict=True):
            place = operand if is_value(operand) else leaf(operand)
            if rule and place is not None and (place in wanted or not is_value(operand)):
                parts.setdefault(place, []).append(rule.format(**names))
                is_sign = number in separate and step.operation in _SIGNS
                size = f"s{number}" if is_sign else parts[place][-1]
                sizes.setdefault(place, []).append(size)
    for place, found in parts.items():
        lines += [] if place in wanted else _total(place, found)
    return lines


def _total(number: int, parts: Sequence[str]) -> list[str]:
    # The macros write their operands repeatedly, so that long sums would grow exponentially.
    name, more = f"d{number}", parts[1:]
    return [f"jet {name} = {parts[0]};", *(f"{name} = ADD({name}, {each});" for each in more)]


def _magnitudes(number: int, parts: Sequence[str]) -> list[str]:
    name = f"s{number}"
    added = (f"{name} = ADD({name}, ABS(t{number}));" for _ in parts)
    each = (f"t{number} = {part};" for part in parts)
    pairs = [line for pair in zip(each, added, strict=True) for line in pair]
    return [f"jet {name} = JET(0.0), t{number};", *pairs]


def used_separately(program: Program) -> set[int]:
    """List the products of which a sum may use the exact value, and something else another one.

    The list has the negatives and sizes of these products too.
    """
    first, found = len(program.inputs), set[int]()
    for number, step in enumerate(program.steps, first):
        uses = _uses(program, number) if step.operation == "mul" else []
        if len(uses) > 1 and {"add", "sub"} & set(uses):
            found.add(number)
        if step.operation in _SIGNS and step.operands[0] in found:
            found.add(number)
    return found


def _uses(program: Program, number: int) -> list[str]:
    """List the operations that use a value, its negative, or its size; an output is one, too."""
    found = ["output"] * _count(program.outputs, number)
    for result, step in enumerate(program.steps, len(program.inputs)):
        times = _count(step.operands, number)
        found += _uses(program, result) if times and step.operation in _SIGNS else []
        found += [step.operation] * times if step.operation not in _SIGNS else []
    return found


def _count(operands: Sequence[Operand], number: int) -> int:
    # The constant 3.0 is not the value number 3.
    return sum(is_value(each) and each == number for each in operands)


def _named(operands: Sequence[Operand], leaf: Callable[[Operand], int | None]) -> list[str]:
    return [operand_name(each, leaf) for each in operands]


def operand_name(operand: Operand, leaf: Callable[[Operand], int | None]) -> str:
    """Write an operand of the code: a value, a constant with a number of its own, or a number."""
    if is_value(operand):
        return f"v{operand}"
    number = leaf(operand)
    return c_number(operand) if number is None else f"v{number}"


def c_number(value: float) -> str:
    """Write a constant as a number in C, exactly."""
    if isinstance(value, bool):
        return str(int(value))
    text = float(value).hex()
    return f"({text})" if text.startswith("-") else text
