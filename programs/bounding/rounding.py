"""A bound of the rounding error of a program in float32, as code for the search.

Let δ be the relative errors of all operations of a program. Its float32 value is F(δ), where F is
the same program with each result multiplied by 1 + δᵢ. By the mean value theorem

    F(δ) − F(0) = Σ δᵢ ∂F/∂δᵢ,

with the derivatives at some number between 0 and δ. In interval arithmetic, each value is widened
by its possible rounding error, so that its interval contains all of these. Therefore

    |F(δ) − F(0)| ≤ Σ uᵢ |dᵢ pᵢ|,

where pᵢ is the result of an operation, dᵢ the derivative of the output by it, and uᵢ the largest
relative error of the operation. Nothing of higher order is left out. A result below the smallest
normal number may become zero, which adds an absolute error. A product and a sum that are fused
have one rounding error less, so the bound holds for them too (`adjoints.py`).

Constants that float32 does not hold are rounded in printed code. The bound contains this: it is
that of the difference from the program with its constants in float64.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import frexp
from pathlib import Path

import numpy as np

from programs.bounding.adjoints import c_number, derivative_lines, operand_name, used_separately
from programs.bounding.rounding_model import ULP, OperationError, RoundingModel
from programs.operations import OPERATIONS
from programs.program import Operand, Program, Step, is_value

_KERNEL = Path(__file__).parent / "kernel" / "rounding.h"
_MOST_CONDITIONS = 64
_CONDITIONS = ("lt", "le", "gt", "ge", "eq", "ne")
_COMPARED = {"lt": "lt2({0}, {1})", "le": "le2({0}, {1})", "eq": "eq2({0}, {1})"}
_COMPARED |= {"gt": "lt2({1}, {0})", "ge": "le2({1}, {0})", "ne": "eq2({0}, {1})"}


def chained(programs: Sequence[Program]) -> Program:
    """Return one program of several: each takes the outputs of the one before it, then its own.

    The inputs are the own ones of each program, in order.
    """
    inputs: list[str] = []
    for k, program in enumerate(programs):
        taken = len(programs[k - 1].outputs) if k else 0
        inputs += program.inputs[taken:]
    steps: list[Step] = []
    outputs: tuple[Operand, ...] = ()
    used = 0
    for program in programs:
        own = len(program.inputs) - len(outputs)
        values: list[Operand] = [*outputs, *range(used, used + own)]
        used += own

        def moved(operand: Operand, values: list[Operand] = values) -> Operand:
            return values[operand] if is_value(operand) else operand

        for step in program.steps:
            values.append(len(inputs) + len(steps))
            steps.append(Step(step.operation, tuple(map(moved, step.operands)), step.hint))
        outputs = tuple(map(moved, program.outputs))
    return Program(programs[-1].name, tuple(inputs), tuple(steps), outputs)


@dataclass(frozen=True)
class _Plan:
    """What is known of a program before its code is written.

    * `errors`: the error of each operation that is not exact, by the number of its result.
    * `constants`: the number under which a constant that float32 does not hold counts as a value.
    * `wanted`: the values by which the output's derivative is needed.
    """

    program: Program
    errors: dict[int, OperationError]
    constants: dict[float, int]
    wanted: set[int]

    def leaf(self, operand: Operand) -> int | None:
        """Return the number of a constant that float32 does not hold; None for another one."""
        return None if isinstance(operand, bool) else self.constants.get(operand)


def rounding_parts(
    program: Program, model: RoundingModel, arguments: str, rounded_inputs: Sequence[bool]
) -> tuple[str, ...]:
    """Return C code of a bound of the rounding error, for `compile_kernel`.

    Arguments: `program`, with one output; `arguments`, C code that fills the array `v` with the
    program's inputs from the variables `x`; `rounded_inputs`, which inputs are rounded to float32
    before they are given to the program. Rounding them is no error of the program. Raises
    ValueError for an operation whose error is not known, and for more than 64 conditions.
    """
    plan = _plan(program, model)
    error = "\n    ".join([*_inputs(plan, arguments, rounded_inputs), *_body(plan)])
    others = f"__COUNTER__ <= {_MOST_CONDITIONS - _conditions(program)}"
    code = [f'_Static_assert({others}, "at most {_MOST_CONDITIONS} conditions");']
    code += [f"static jet error_of(boxes *K, const jet *x) {{\n    {error}\n}}"]
    if _conditions(program):
        given = [*_inputs(plan, arguments, rounded_inputs), *_values(plan)]
        value = "\n    ".join([*given, *_exact_values(program)])
        code.append(f"static jet value_of(boxes *K, const jet *x) {{\n    {value}\n}}")
        entry = "return over_outcomes(K, x, error_of, value_of);"
    else:
        entry = "return error_of(K, x);"
    code.append(f"static jet error_at(boxes *K, const jet *x) {{ {entry} }}")
    return (_KERNEL.read_text("utf-8"), *code)


def _conditions(program: Program) -> int:
    return sum(step.operation in _CONDITIONS for step in program.steps)


def _plan(program: Program, model: RoundingModel) -> _Plan:
    if (count := _conditions(program)) > _MOST_CONDITIONS:
        raise ValueError(f"{program.name}: {count} conditions; allowed: at most {_MOST_CONDITIONS}")
    first, errors, constants, wanted = len(program.inputs), {}, {}, set()
    last = first + len(program.steps)
    for number, step in enumerate(program.steps, first):
        if step.operation not in model.errors:
            raise ValueError(
                f"{program.name}: the rounding of {step.operation!r} has no known bound in the "
                f"model {model.name!r}"
            )
        error = model.errors[step.operation]
        if not error.none:
            errors[number] = OperationError() if _is_exact(step, error) else error
        inexact = [
            operand
            for operand in step.operands
            if not is_value(operand) and _float32(operand) != operand
        ]
        for operand in inexact:
            constants.setdefault(operand, last + len(constants))
        if OPERATIONS[step.operation].gives == "bool":
            continue
        moves = inexact or any(is_value(o) and o in wanted for o in step.operands)
        if number in errors or moves:
            wanted.add(number)
    return _Plan(program, errors, constants, wanted)


def _float32(constant: Operand) -> float:
    with np.errstate(over="ignore"):
        return float(np.float32(constant))


def _is_exact(step: Step, error: OperationError) -> bool:
    """Return whether a step only changes the exponent: x + x, or a product with a power of two.

    The result may still be too small for a normal number.
    """
    if step.operation == "add":
        return is_value(step.operands[0]) and step.operands[0] == step.operands[1]
    # A product that float32 holds is exact in each model; a quotient is where it is rounded right.
    divisor = step.operation == "div" and error.ulps <= 0.5
    scales = step.operands[1:] if divisor else step.operands if step.operation == "mul" else ()
    return any(not is_value(each) and abs(frexp(each)[0]) == 0.5 for each in scales)


def _inputs(plan: _Plan, arguments: str, rounded_inputs: Sequence[bool]) -> list[str]:
    lines = [f"jet v[{len(plan.program.inputs)}];", arguments]
    for k, is_rounded in enumerate(rounded_inputs):
        lines += [f"v[{k}] = rounded(K, v[{k}], 0x1p-24, LEAST_NORMAL);"] if is_rounded else []
        lines.append(f"jet v{k} = v[{k}];")
    return lines


def _values(plan: _Plan) -> list[str]:
    """Write the values of all steps: p of the exact and v of the rounded result."""
    lines, program, condition = [], plan.program, 0
    for constant, number in plan.constants.items():
        ends = sorted([constant, _float32(constant)])
        lines.append(f"jet v{number} = inexact(K, {', '.join(map(c_number, ends))});")
    for number, step in enumerate(program.steps, len(program.inputs)):
        operands = [operand_name(each, plan.leaf) for each in step.operands]
        if step.operation in _CONDITIONS:
            given = _COMPARED[step.operation].format(*(f"JET({each})" for each in operands))
            # Conditions of the code that computes the arguments are numbered from zero.
            decided = f"decide(K, {_MOST_CONDITIONS - 1 - condition}, {given})"
            decided = f"not1({decided})" if step.operation == "ne" else decided
            lines.append(f"truth v{number} = {decided};")
            condition += 1
            continue
        text = f"{step.operation.upper()}({', '.join(operands)})"
        if OPERATIONS[step.operation].gives == "bool":
            lines.append(f"truth v{number} = {text};")
        elif number in plan.errors:
            lines += [
                f"jet p{number} = {text};",
                f"jet v{number} = {_rounded(number, plan.errors[number], operands)};",
            ]
        else:
            lines += [f"jet p{number} = {text};", f"jet v{number} = p{number};"]
    return lines


def _exact_values(program: Program) -> list[str]:
    """Write w, the results without rounding, and return that of the program.

    Conditions are those of rounded values: they have the outcome that rounding may give, also where
    the exact values have another one.
    """
    lines, first = [], len(program.inputs)

    def name(operand: Operand) -> str:
        step = program.steps[operand - first] if is_value(operand) and operand >= first else None
        is_exact = step is not None and OPERATIONS[step.operation].gives == "real"
        return f"w{operand}" if is_exact else operand_name(operand, lambda _: None)

    for number, step in enumerate(program.steps, first):
        if OPERATIONS[step.operation].gives == "real":
            operands = ", ".join(map(name, step.operands))
            lines.append(f"jet w{number} = {step.operation.upper()}({operands});")
    return [*lines, f"return JET({name(program.outputs[0])});"]


def _rounded(number: int, error: OperationError, operands: Sequence[str]) -> str:
    part, absolute = error.ulps * ULP, f"{c_number(error.absolute)} + LEAST_NORMAL"
    if not error.ulps_of_argument:
        return f"rounded(K, p{number}, {c_number(part)}, {absolute})"
    more = c_number(error.ulps_of_argument * ULP)
    return f"rounded_more(K, p{number}, {c_number(part)}, {absolute}, {more}, JET({operands[0]}))"


def _body(plan: _Plan) -> list[str]:
    """Write the bound: the sum of the errors of all operations, times the derivatives by them."""
    lines = [*_values(plan), *derivative_lines(plan.program, plan.wanted, plan.leaf)]
    lines += ["jet e = JET(0.0);", "V tiny = all(0);"]
    first, separate = len(plan.program.inputs), used_separately(plan.program)
    sizes = {number: f"{'s' if number in separate else 'd'}{number}" for number in plan.errors}
    for part in sorted({error.ulps for error in plan.errors.values() if error.ulps}):
        lines.append("{ jet s = JET(0.0);")
        for number, error in plan.errors.items():
            if error.ulps == part:
                lines.append(f"s = ADD(s, ABS(MUL({sizes[number]}, p{number})));")
        lines.append(f"e = ADD(e, MUL({c_number(part * ULP)}, s)); }}")
    for number, error in plan.errors.items():
        lines.append(f"tiny += size_of({sizes[number]});")
        if error.ulps_of_argument:
            argument = operand_name(plan.program.steps[number - first].operands[0], plan.leaf)
            lines += [
                f"{{ jet s = MUL(d{number}, p{number});",
                f"s = ABS(MUL(s, {argument}));",
                f"e = ADD(e, MUL({c_number(error.ulps_of_argument * ULP)}, s)); }}",
            ]
        if error.absolute:
            lines.append(f"e = ADD(e, MUL({c_number(error.absolute)}, ABS(d{number})));")
    # A constant that is only compared with changes no value, but may change an outcome.
    used = {
        operand
        for step in plan.program.steps
        if OPERATIONS[step.operation].gives == "real"
        for operand in step.operands
    }
    for constant, number in plan.constants.items():
        if constant in used:
            apart = c_number(np.nextafter(abs(_float32(constant) - constant), np.inf))
            lines.append(f"e = ADD(e, MUL({apart}, ABS(d{number})));")
    return [*lines, "return wider(e, tiny * LEAST_NORMAL);"]
