"""Certificates: a form has no pole and no NaN on its whole domain, not only at samples of it."""

from dataclasses import dataclass

import numpy as np

from fitting.form import Form, box_of, constant, traced
from programs.bounding.branch_and_bound import bound_output
from programs.bounding.interval import enclose
from programs.program import Program, is_value, part

# Bounds are within this factor of a value that is attained.
TIGHTNESS = 0.9
# Sums and products: none that is zero is rounded below this.
NOWHERE_NEGATIVE = (-1e-300, np.inf)
POSITIVE = (np.nextafter(0, 1), np.inf)
# Of a root and a logarithm the operand, and what is allowed of it. All operations but these and the
# division that have an interval version are defined everywhere.
ALLOWED = {"sqrt": NOWHERE_NEGATIVE, "log": POSITIVE}


@dataclass(frozen=True)
class Certificate:
    """`bound` is a lower bound of every denominator on the whole domain; +∞ if there is none.

    `boxes` is the number of boxes that the domain was split into to prove it.
    """

    bound: float
    boxes: int

    @property
    def holds(self) -> bool:
        """Whether no denominator vanishes, and no root or logarithm is of a negative number."""
        return self.bound > 0


def certify_denominators(form: Form, enough: float = np.inf) -> Certificate:
    """Bound every divisor in a form's expression from below, over the form's whole domain.

    Radicands are shown not to be negative, and arguments of logarithms to be positive. A bound of
    `enough` is not improved upon. Raises ValueError for an operation that has no interval version.
    """
    call, axes = constant(form).unguarded()
    program, box = traced(form, call, axes), box_of(axes)
    # What has no interval version may have poles of its own.
    enclose(program, *box.T[:, None])
    bound, boxes = np.inf, 0
    for operand in operands(program, "div", 1):
        found = bound_below(part(program, [operand]), box, enough)
        bound, boxes = min(bound, found.bound), boxes + found.boxes
        if not found.holds:
            return Certificate(-np.inf, boxes)
    for operation, allowed in ALLOWED.items():
        for operand in operands(program, operation, 0):
            found = bound_output(part(program, [operand]), box, allowed, within(allowed))
            boxes += found.boxes
            if not np.isfinite(found.lower):
                return Certificate(-np.inf, boxes)
    return Certificate(bound, boxes)


def bound_below(program: Program, box: np.ndarray, enough: float = np.inf) -> Certificate:
    """Bound a program's only output from below on a box (inputs, 2).

    The bound is within `TIGHTNESS` of the least output that is attained, or at least `enough`, if
    that is positive and it can be shown; else it is −∞.
    """

    def settled(below, above, least, most):
        return below >= min(TIGHTNESS * least, enough)

    found = bound_output(program, box, POSITIVE, settled)
    return Certificate(found.lower, found.boxes)


def within(allowed: tuple[float, float]):
    """Tell which boxes need not be split to show that all values are allowed."""
    return lambda below, above, least, most: (below >= allowed[0]) & (above <= allowed[1])


def operands(program: Program, operation: str, place: int) -> list[int]:
    """Give the values that are operands of an operation, by their place among them."""
    found = {step.operands[place] for step in program.steps if step.operation == operation}
    return sorted(filter(is_value, found))
