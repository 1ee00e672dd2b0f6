"""Certificates: bounds of a form over its whole domain, not at samples of it."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from fitting.form import Form
from fitting.interval import enclose
from integrals import Axis
from programs.function import Function, Parameter
from programs.program import Program, evaluate, is_value
from programs.trace import trace

# Boxes are split until the bound is within this factor of a value that is attained.
TIGHTNESS = 0.9
MAX_BOXES = 400_000
# A box that has shrunk to this part of the domain without a positive bound may well hold a zero.
SMALLEST_BOX = 1e-9


@dataclass(frozen=True)
class Certificate:
    """`bound` is a lower bound of every denominator on the whole domain; +∞ if there is none.

    `boxes` is the number of boxes that the domain was split into to prove it.
    """

    bound: float
    boxes: int

    @property
    def holds(self) -> bool:
        """Whether no denominator vanishes."""
        return self.bound > 0


def certify_denominators(form: Form, enough: float = np.inf) -> Certificate:
    """Bound every divisor in a form's expression from below, over the form's whole domain.

    A bound of `enough` is not improved upon.
    """
    relaxed = form.relaxed()
    if relaxed is not None:
        found = _bound_divisors(traced(form, *relaxed), relaxed[1], enough)
        if found.holds:
            return found
    return _bound_divisors(as_program(form), form.axes, enough)


def _bound_divisors(program: Program, axes: tuple[Axis, ...], enough: float) -> Certificate:
    found = divisors(program)
    if not found.outputs:
        return Certificate(np.inf, 0)
    lower = np.array([axis.lower for axis in axes])
    upper = np.array([axis.upper for axis in axes])
    return bound_below(found, lower, upper, enough)


def as_program(form: Form) -> Program:
    """Trace a form, its coefficients constants, as a function of its axes."""
    return traced(form, type(form)(np.asarray(form.coefficients)), form.axes)


def traced(form: Form, call, axes: tuple[Axis, ...], results: int | None = None) -> Program:
    """Trace a function of a form on some axes: of a scalar, or of a tuple of `results`."""
    parameters = tuple(Parameter(axis.name, (axis.lower, axis.upper)) for axis in axes)
    summary = f"{form.integral.symbol} by {form.equation}"
    return trace(Function(form.integral.name, summary, parameters, results, "value", call))


def divisors(program: Program) -> Program:
    """Give the program whose outputs are the divisors of a program's divisions."""
    found = {
        step.operands[1]
        for step in program.steps
        if step.operation == "div" and is_value(step.operands[1])
    }
    return replace(program, outputs=tuple(sorted(found)))


def bound_below(
    program: Program, lower: np.ndarray, upper: np.ndarray, enough: float = np.inf
) -> Certificate:
    """Bound all outputs of a program from below on the box [lower, upper], by branch and bound.

    The bound is within `TIGHTNESS` of the least output that is attained, or at least `enough`, if
    that is positive and boxes within the limits on their number and size show it; else it is −∞.
    """
    low, high = lower[None], upper[None]
    # An input that the outputs do not depend on is never split.
    used = np.array([k in reached(program) for k in range(len(lower))]) & (upper > lower)
    scale = np.where(used, upper - lower, np.inf)
    # No box's middle is a corner of the domain, where a denominator is often least.
    corners = np.array(list(product(*zip(lower, upper, strict=True))))
    attained, proven, boxes = evaluate(program, corners).min(), np.inf, 0
    while len(low):
        # np.minimum, unlike min, keeps a NaN
        attained = np.minimum(attained, evaluate(program, (low + high) / 2).min())
        boxes += len(low)
        smallest = np.min(np.max((high - low) / scale, axis=1))
        if not attained > 0 or boxes > MAX_BOXES or smallest < SMALLEST_BOX:
            return Certificate(-np.inf, boxes)
        bounds = np.min([each.lower for each in enclose(program, low, high)], axis=0)
        done = bounds >= min(TIGHTNESS * attained, enough)
        proven = min(proven, bounds[done].min(initial=np.inf))
        low, high = low[~done], high[~done]
        low, high = split(low, high, (high - low) / scale)
    return Certificate(float(proven), boxes)


def reached(program: Program) -> set[int]:
    """Give the numbers of the values that a program's outputs depend on, inputs included."""
    needed = {operand for operand in program.outputs if is_value(operand)}
    first = len(program.inputs)
    for number in range(first + len(program.steps) - 1, first - 1, -1):
        if number in needed:
            needed.update(filter(is_value, program.steps[number - first].operands))
    return needed


def split(low: np.ndarray, high: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split every box in two along its longest side: of those of largest `size` (boxes, inputs)."""
    side = np.argmax(size, axis=1)
    rows = np.arange(len(low))
    middle = (low[rows, side] + high[rows, side]) / 2
    left_high, right_low = high.copy(), low.copy()
    left_high[rows, side] = right_low[rows, side] = middle
    return np.concatenate([low, right_low]), np.concatenate([left_high, high])
