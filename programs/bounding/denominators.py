"""Proofs that a program has no pole, no NaN and no overflow on a whole box, not only at samples.

The size of every divisor is bounded from below by a positive number. The operands of all other
operations that are not defined everywhere are shown to be in their domains. Then every intermediate
value is shown to be finite in float64. A proof is about exact arithmetic: a value that exactly is
zero may be negative after rounding.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from programs.bounding.branch_and_bound import BranchAndBound, Settled
from programs.bounding.finite import unbounded_values
from programs.bounding.interval import enclose
from programs.program import Program, Step, evaluate, is_value, subprogram

# A proven bound is at least this factor times the least value that is attained.
TIGHTNESS = 0.9
NOWHERE_NEGATIVE = (0.0, np.inf)
POSITIVE = (np.nextafter(0, 1), np.inf)
FINITE = (-np.finfo(float).max, np.finfo(float).max)
# Operation -> the values that its operand may have
ALLOWED = {"sqrt": NOWHERE_NEGATIVE, "log": POSITIVE}
_UNIT = (-1.0, 1.0)
# The same for all operations of one operand that are not defined everywhere
_DOMAINS = ALLOWED | {
    "rsqrt": POSITIVE,
    "log1p": (np.nextafter(-1, 0), np.inf),
    "asin": _UNIT,
    "acos": _UNIT,
}
# No value of theirs is changed by an infinite constant.
_LIMITS = ("min", "max")
SOLVER = BranchAndBound()


@dataclass(frozen=True)
class DenominatorBound:
    """A proven lower bound of the size of every denominator on a box.

    `bound` is +∞ if there is no denominator, and −∞ if nothing is proven. `boxes` is the number of
    boxes that were examined for denominators and domains.
    """

    bound: float
    boxes: int

    @property
    def holds(self) -> bool:
        """Whether it is proven that no denominator vanishes and no operand is out of domain."""
        return self.bound > 0


def prove_no_pole(
    program: Program,
    box: np.ndarray,
    enough: float = np.inf,
    solver: BranchAndBound = SOLVER,
) -> DenominatorBound:
    """Bound the size of every divisor from below on a box.

    A divisor may be negative everywhere instead of positive. Operands of roots, logarithms and
    other operations are shown to be in their domain too, and all values to be finite. Divisors that
    are constants are only shown not to be zero. Arguments: `box`
    (inputs, 2), the ends of each side; `enough`, a bound that need not be improved; `solver`, with
    its limits. Trace the program with `keep_undefined`, else x·0 and 1/0 are no part of it. Returns
    the least of the bounds; −∞ if something is not proven. Raises ValueError for an operation that
    has no interval version, since it may have poles of its own.
    """
    enclose(program, *box.T[:, None])
    bound, boxes = np.inf, 0
    # The proven lower bounds of values
    proven: dict[int, float] = {}
    finite = all(is_value(each) or np.isfinite(each) for each in program.outputs)
    if not (finite and all(map(_is_defined, program.steps))):
        return DenominatorBound(-np.inf, boxes)
    for operand in operands(program, "div", 1):
        part = subprogram(program, [operand])
        negative = evaluate(part, box.mean(axis=1)[None])[0, 0] < 0
        if negative:
            part = _extended(program, (Step("neg", (operand,)),))
        found = bound_below(part, box, enough, solver)
        bound, boxes = min(bound, found.bound), boxes + found.boxes
        if not found.holds:
            return DenominatorBound(-np.inf, boxes)
        if not negative:
            proven[operand] = found.bound
    for value, part, allowed in _domains(program):
        shown = solver.bound_output(part, box, allowed, within(allowed))
        boxes += shown.boxes
        if not np.isfinite(shown.lower):
            return DenominatorBound(-np.inf, boxes)
        if value is not None:
            proven[value] = max(shown.lower, proven.get(value, -np.inf))
    for value in unbounded_values(program, box, proven):
        shown = solver.bound_output(subprogram(program, [value]), box, FINITE, within(FINITE))
        if not np.isfinite(shown.lower):
            return DenominatorBound(-np.inf, boxes)
    return DenominatorBound(bound, boxes)


def bound_below(
    program: Program,
    box: np.ndarray,
    enough: float = np.inf,
    solver: BranchAndBound = SOLVER,
) -> DenominatorBound:
    """Bound the only output of a program from below on a box (inputs, 2).

    The bound is at least `TIGHTNESS` times the least output that is attained, or at least `enough`.
    It is −∞ if the output is not proven to be positive.
    """

    def settled(below, above, least, most):
        return below >= min(TIGHTNESS * least, enough)

    found = solver.bound_output(program, box, POSITIVE, settled)
    return DenominatorBound(found.lower, found.boxes)


def within(allowed: tuple[float, float]) -> Settled:
    """Return the rule that a box need not be divided once its bounds lie within `allowed`."""
    return lambda below, above, least, most: (below >= allowed[0]) & (above <= allowed[1])


def operands(program: Program, operation: str, place: int) -> list[int]:
    """List the values, without constants, that are operand number `place` of an operation."""
    # Constants are left out first: in a set, the constant 3.0 would hide the value number 3.
    found = (step.operands[place] for step in program.steps if step.operation == operation)
    return sorted(set(filter(is_value, found)))


def _is_defined(step: Step) -> bool:
    """Tell whether a step is defined as far as its constants decide it."""
    constants = [x for x in step.operands if not is_value(x) and not isinstance(x, bool)]
    if step.operation in _LIMITS:
        return not np.isnan(constants).any()
    if not np.isfinite(constants).all():
        return False
    if len(constants) == len(step.operands):
        # Such a step was kept because its result is not finite.
        return False
    if step.operation == "div":
        return is_value(step.operands[1]) or step.operands[1] != 0
    return step.operation != "pow" or is_value(step.operands[0]) or step.operands[0] > 0


def _domains(program: Program) -> Iterator[tuple[int | None, Program, tuple[float, float]]]:
    """Yield what must be shown of operands: a value or None, a program, and what it may return.

    The program returns the value, or, with None, a number that is in the range only if the operands
    are in the domain of their operation.
    """
    for operation, allowed in _DOMAINS.items():
        for operand in operands(program, operation, 0):
            yield operand, subprogram(program, [operand]), allowed
    # The number of the first step that is added to the program
    new = len(program.inputs) + len(program.steps)
    for operand in operands(program, "tan", 0):
        steps = (Step("cos", (operand,)), Step("mul", (new, new)))
        yield None, _extended(program, steps), POSITIVE
    for step in program.steps:
        if step.operation == "pow" and is_value(base := step.operands[0]):
            # 0 to a positive power is 0. A negative number has powers that are no real numbers.
            exponent = step.operands[1]
            allowed = POSITIVE if is_value(exponent) or exponent < 0 else NOWHERE_NEGATIVE
            yield base, subprogram(program, [base]), allowed
        if step.operation == "atan2":
            squares = tuple(Step("mul", (each, each)) for each in step.operands)
            yield None, _extended(program, (*squares, Step("add", (new, new + 1)))), POSITIVE


def _extended(program: Program, steps: tuple[Step, ...]) -> Program:
    """Return the program that computes further steps; its output is the last one."""
    last = len(program.inputs) + len(program.steps) + len(steps) - 1
    whole = Program(program.name, program.inputs, (*program.steps, *steps), ())
    return subprogram(whole, [last])
