"""Straight-line programs: inputs, a list of single assignments, outputs, and their evaluation."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np

from programs.operations import OPERATIONS

# An operand is the number of a value (an int) or a constant (a float). Values are numbered from
# zero: first the inputs, then the results of the steps, in order.
Operand = int | float


@dataclass(frozen=True)
class Step:
    """One assignment: an operation (a key of OPERATIONS) and its operands.

    `hint` is the name that the author of the function gave the result, or None.
    """

    operation: str
    operands: tuple[Operand, ...]
    hint: str | None = None


@dataclass(frozen=True)
class Program:
    """A function without branches or loops: what is printed, counted and evaluated.

    `inputs` are the names of the scalar inputs, `steps` the assignments (each only uses earlier
    values), `outputs` the operands that are returned. Every step is used.
    """

    name: str
    inputs: tuple[str, ...]
    steps: tuple[Step, ...]
    outputs: tuple[Operand, ...]


def is_value(operand: Operand) -> TypeGuard[int]:
    """Tell a number of a value from a constant."""
    # bool is a subclass of int: conditions that are known are constants, no numbers of values.
    return type(operand) is int


def reached(program: Program) -> set[int]:
    """Give the numbers of the values that a program's outputs depend on, inputs included."""
    needed = {operand for operand in program.outputs if is_value(operand)}
    first = len(program.inputs)
    for number in range(first + len(program.steps) - 1, first - 1, -1):
        if number in needed:
            needed.update(filter(is_value, program.steps[number - first].operands))
    return needed


def part(program: Program, outputs: Sequence[Operand]) -> Program:
    """Give the program of some of a program's values: the steps that they need, renumbered."""
    first = len(program.inputs)
    needed = reached(replace(program, outputs=tuple(outputs)))
    kept = [number for number in sorted(needed) if number >= first]
    renumbered = {**{k: k for k in range(first)}, **{old: first + k for k, old in enumerate(kept)}}

    def moved(operands: Sequence[Operand]) -> tuple[Operand, ...]:
        return tuple(renumbered[o] if is_value(o) else float(o) for o in operands)

    steps = (program.steps[number - first] for number in kept)
    return Program(
        program.name,
        program.inputs,
        tuple(replace(step, operands=moved(step.operands)) for step in steps),
        moved(outputs),
    )


def interpret(
    program: Program,
    inputs: Sequence[Any],
    operations: Mapping[str, Callable[..., Any]],
    constant: Callable[[float], Any],
) -> tuple[Any, ...]:
    """Evaluate a program over any kind of number: intervals, arrays, counters.

    Arguments: `inputs`, one value an input; `operations`, what to call for each key of OPERATIONS
    that occurs; `constant`, which makes such a number of a float. Returns one value an output.
    Raises ValueError when the number of inputs is wrong or an operation is missing.
    """
    if len(inputs) != len(program.inputs):
        raise ValueError(
            f"{program.name} was given {len(inputs)} inputs; allowed: {len(program.inputs)}"
        )
    values = list(inputs)

    def fetch(operand: Operand) -> Any:
        return values[operand] if is_value(operand) else constant(operand)

    for step in program.steps:
        if step.operation not in operations:
            raise ValueError(
                f"operation {step.operation!r} in {program.name} has no meaning here; "
                f"allowed: {', '.join(sorted(operations))}"
            )
        values.append(operations[step.operation](*map(fetch, step.operands)))
    return tuple(fetch(operand) for operand in program.outputs)


def evaluate(
    program: Program, inputs: np.ndarray, dtype: type[np.floating] = np.float64
) -> np.ndarray:
    """Evaluate a program at many points, every operation rounded to `dtype`.

    Arguments: `inputs` (n, k), one row a point, rounded to `dtype` first; `dtype`, np.float16,
    np.float32 or np.float64. Returns (n, m) in `dtype`. Outside a function's domain the result is
    NaN or infinite, as in the printed code. Raises ValueError when the columns are not the inputs.
    """
    rows = np.asarray(inputs, dtype)
    if rows.ndim != 2:
        raise ValueError(f"inputs of {program.name} have shape {rows.shape}; allowed: (n, k)")
    table = {name: operation.numpy for name, operation in OPERATIONS.items()}
    with np.errstate(all="ignore"):
        results = interpret(program, list(rows.T), table, dtype)
    columns = [np.broadcast_to(np.asarray(result, dtype), len(rows)) for result in results]
    return np.stack(columns, axis=1)
