"""Straight-line programs: inputs, a list of assignments and outputs; and their evaluation."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np

from programs.operations import OPERATIONS

# An operand is either a constant (a float) or the number of a value (an int). Values are numbered
# from zero: first the inputs, then the result of each step, in order.
Operand = int | float

# Points are evaluated in parts whose values of all steps take about this many bytes, but in parts
# of at least so many points.
_BYTES, _LEAST_ROWS = 1 << 27, 1 << 12


@dataclass(frozen=True)
class Step:
    """One assignment: an operation (a key of OPERATIONS) and its operands.

    `hint` is the name of the variable that the function's author assigned the result to, or None.
    """

    operation: str
    operands: tuple[Operand, ...]
    hint: str | None = None


@dataclass(frozen=True)
class Program:
    """A function without branches or loops, as it is printed, counted, bounded and evaluated.

    `inputs` are the names of the scalar inputs. `steps` are the assignments; each uses only values
    before it, and an output depends on each. `outputs` are the operands that are returned.
    """

    name: str
    inputs: tuple[str, ...]
    steps: tuple[Step, ...]
    outputs: tuple[Operand, ...]


def is_value(operand: Operand) -> TypeGuard[int]:
    """Return whether an operand is the number of a value; if not, it is a constant."""
    # isinstance would not do: bool is a subclass of int, and True and False are constants.
    return type(operand) is int


def reachable_values(program: Program) -> set[int]:
    """Return the numbers of all values that the outputs depend on, inputs included."""
    needed = {operand for operand in program.outputs if is_value(operand)}
    first = len(program.inputs)
    for number in range(first + len(program.steps) - 1, first - 1, -1):
        if number in needed:
            needed.update(filter(is_value, program.steps[number - first].operands))
    return needed


def subprogram(program: Program, outputs: Sequence[Operand]) -> Program:
    """Return the program that computes `outputs`, which are values of `program`, and no more.

    It has the same inputs. Steps that are not needed are left out, and the rest is renumbered.
    """
    first = len(program.inputs)
    needed = reachable_values(replace(program, outputs=tuple(outputs)))
    kept = [number for number in sorted(needed) if number >= first]
    renumbered = {**{k: k for k in range(first)}, **{old: first + k for k, old in enumerate(kept)}}

    def renumber(operands: Sequence[Operand]) -> tuple[Operand, ...]:
        return tuple(renumbered[o] if is_value(o) else float(o) for o in operands)

    steps = (program.steps[number - first] for number in kept)
    return Program(
        program.name,
        program.inputs,
        tuple(replace(step, operands=renumber(step.operands)) for step in steps),
        renumber(outputs),
    )


def interpret(
    program: Program,
    inputs: Sequence[Any],
    operations: Mapping[str, Callable[..., Any]],
    constant: Callable[[float], Any],
) -> tuple[Any, ...]:
    """Evaluate a program with any kind of number: arrays, intervals, symbols.

    Arguments: `inputs`, one number for each input; `operations`, a function for each operation (a
    key of OPERATIONS) that occurs; `constant`, which converts a float to that kind of number.
    Returns one number for each output. Raises ValueError when the number of inputs is wrong or an
    operation is missing.
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
    """Evaluate a program at many points with NumPy; every operation is rounded to `dtype`.

    Arguments: `inputs` (n, k), one row for each point and one column for each input, rounded to
    `dtype` first; `dtype`, np.float16, np.float32 or np.float64. Returns (n, m) in `dtype`, one
    column for each output. Where an operation is undefined the result is NaN or infinite, as in
    printed code. Raises ValueError for inputs of another shape.
    """
    rows = np.asarray(inputs, dtype)
    if rows.ndim != 2:
        raise ValueError(f"inputs of {program.name} have shape {rows.shape}; allowed: (n, k)")
    numbers = (len(program.inputs) + len(program.steps)) * np.dtype(dtype).itemsize
    count = max(_LEAST_ROWS, _BYTES // max(numbers, 1))
    table = {name: operation.numpy for name, operation in OPERATIONS.items()}
    found = np.empty((len(rows), len(program.outputs)), dtype)
    for start in range(0, len(rows), count):
        part = rows[start : start + count]
        with np.errstate(all="ignore"):
            results = interpret(program, list(part.T), table, dtype)
        for k, result in enumerate(results):
            found[start : start + count, k] = result
    return found
