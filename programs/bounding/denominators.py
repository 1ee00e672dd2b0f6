"""Proofs that a program has no pole and no NaN on a whole box, not only at samples of it.

Every divisor is bounded from below by a positive number. Radicands are shown not to be negative,
and arguments of logarithms to be positive. The other operations that have an interval version are
defined everywhere.
"""

from dataclasses import dataclass

import numpy as np

from programs.bounding.branch_and_bound import BranchAndBound, Settled
from programs.bounding.interval import enclose
from programs.program import Program, is_value, subprogram

# A proven bound is at least this factor times the least value that is attained.
TIGHTNESS = 0.9
# Outward rounding may push an exact zero this far below zero.
NOWHERE_NEGATIVE = (-1e-300, np.inf)
POSITIVE = (np.nextafter(0, 1), np.inf)
# Operation -> the values that its operand may have
ALLOWED = {"sqrt": NOWHERE_NEGATIVE, "log": POSITIVE}
SOLVER = BranchAndBound()


@dataclass(frozen=True)
class DenominatorBound:
    """A proven lower bound of every denominator on a box.

    `bound` is +∞ if there is no denominator, and −∞ if nothing is proven. `boxes` is the number of
    boxes that were examined.
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
    """Bound every divisor of a program from below on a box.

    Radicands and arguments of logarithms are shown to be in their domain too. Arguments: `box`
    (inputs, 2), the ends of each side; `enough`, a bound that need not be improved; `solver`, with
    its limits. Returns the least of the bounds; −∞ if something is not proven. Raises ValueError
    for an operation that has no interval version, since it may have poles of its own.
    """
    enclose(program, *box.T[:, None])
    bound, boxes = np.inf, 0
    for operand in operands(program, "div", 1):
        found = bound_below(subprogram(program, [operand]), box, enough, solver)
        bound, boxes = min(bound, found.bound), boxes + found.boxes
        if not found.holds:
            return DenominatorBound(-np.inf, boxes)
    for operation, allowed in ALLOWED.items():
        for operand in operands(program, operation, 0):
            part = subprogram(program, [operand])
            shown = solver.bound_output(part, box, allowed, within(allowed))
            boxes += shown.boxes
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
