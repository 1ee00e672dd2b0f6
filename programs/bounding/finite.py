"""Which values of a program may overflow on a box: a quick test by natural interval bounds."""

from collections.abc import Mapping

import numpy as np

from programs.bounding import interval
from programs.bounding.arithmetic import Interval
from programs.program import Operand, Program, is_value


def unbounded_values(program: Program, box: np.ndarray, proven: Mapping[int, float]) -> list[int]:
    """List the values of a program whose natural bounds on a box are not finite.

    Arguments: `box` (inputs, 2); `proven`, lower bounds of values that are known already, such as
    those of denominators. The list ends with the first value that is not bounded and on which all
    further ones may depend. Once a value is in it, it counts as bounded by the largest number.
    """
    values: list[Interval | None] = [Interval(low[None], high[None]) for low, high in box]
    largest = np.finfo(float).max
    found = []

    def fetch(operand: Operand) -> Interval | None:
        if is_value(operand):
            return values[operand]
        return Interval(np.array([float(operand)]), np.array([float(operand)]))

    for number, step in enumerate(program.steps, start=len(program.inputs)):
        bounds = interval.image_of(step.operation, [fetch(each) for each in step.operands])
        if bounds is not None:
            lower = np.fmax(bounds.lower, proven.get(number, -np.inf))
            if not np.isfinite([*lower, *bounds.upper]).all():
                found.append(number)
                lower, upper = np.fmax(lower, -largest), np.fmin(bounds.upper, largest)
                bounds = Interval(lower, upper)
            else:
                bounds = Interval(lower, bounds.upper)
        values.append(bounds)
    return found
