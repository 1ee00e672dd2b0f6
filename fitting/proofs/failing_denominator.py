"""Which denominator of a form fails, and where: a text for the message that refuses a fit."""

import numpy as np

from fitting.form import FittedForm
from fitting.linearity import program_of
from fitting.points.scattered import scattered_points
from programs.bounding.denominators import operands
from programs.printing.formula import formulas
from programs.program import evaluate, subprogram

# The form's divisors are evaluated at 2^_TRIED points and half as many near the boundary.
_TRIED, _SEED = 13, 20201129
# A longer formula is not shown.
_LONGEST = 120


def failing_denominator(fitted: FittedForm) -> str:
    """Return ': it is VALUE at POINT' for the divisor that comes nearest to zero, with its formula.

    Returns an empty text for a form without divisors.
    """
    form = fitted.form
    program = program_of(form)
    divisors = operands(program, "div", 1)
    if not divisors:
        return ""
    points = scattered_points(form.reference, form.axes, _TRIED, _SEED)
    constants = np.tile(fitted.constants.ravel(), (len(points), 1))
    values = evaluate(subprogram(program, divisors), np.concatenate([constants, points], axis=1))
    # What is left of a divisor, relative to its usual size and with its usual sign
    usual = np.median(values, axis=0)
    room = values / np.where(usual == 0, 1.0, usual)
    row, column = np.unravel_index(np.argmin(np.where(np.isnan(room), -np.inf, room)), room.shape)
    names = [*map(str, np.ravel(form.coefficient_names)), *(axis.symbol for axis in form.axes)]
    (text,) = formulas(subprogram(program, [divisors[column]]), names)
    what = f"{text} " if len(text) <= _LONGEST else "it "
    where = ", ".join(
        f"{axis.name} = {value:.6g}" for axis, value in zip(form.axes, points[row], strict=True)
    )
    return f": {what}is {values[row, column]:.3g} at {where}"
