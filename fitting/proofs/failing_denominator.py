"""What of a form fails the proof, and where: a text for the message that refuses a fit."""

import numpy as np

from fitting.form import FittedForm
from fitting.linearity import program_of
from fitting.points.scattered import scattered_points
from programs.bounding.denominators import operands
from programs.printing.formula import formulas
from programs.program import evaluate, subprogram

# The operands are evaluated at 2^_TRIED points and half as many near the boundary.
_TRIED, _SEED = 13, 20201129
# A longer formula is not shown.
_LONGEST = 120
_DENOMINATOR = "a denominator"
# What to call the operand of an operation, and the place of the operand
_CALLED = {
    "div": (_DENOMINATOR, 1),
    "sqrt": ("a radicand", 0),
    "rsqrt": ("a radicand", 0),
    "log": ("an argument of a logarithm", 0),
    "pow": ("a base of a power", 0),
}


def failing_denominator(fitted: FittedForm) -> str:
    """Return which denominator or radicand is not shown to be positive, with its value and place.

    It is the one that comes nearest to zero at some points, such as 'a radicand that is not shown
    to be positive on its whole domain: x − a is -0.2 at x = 0'. A form without any has a value that
    may be infinite.
    """
    form = fitted.form
    program = program_of(form)
    called = {
        operand: noun
        for operation, (noun, place) in _CALLED.items()
        for operand in operands(program, operation, place)
    }
    if not called:
        return "a value that is not shown to be finite on its whole domain"
    tried = list(called)
    points = scattered_points(form.reference, form.axes, _TRIED, _SEED)
    constants = np.tile(fitted.constants.ravel(), (len(points), 1))
    values = evaluate(subprogram(program, tried), np.concatenate([constants, points], axis=1))
    # What is left of a divisor, relative to its usual size and with its usual sign
    usual = np.median(values, axis=0)
    signed = [noun == _DENOMINATOR for noun in called.values()]
    usual = np.where(signed, usual, np.abs(usual))
    room = values / np.where(usual == 0, 1.0, usual)
    row, column = np.unravel_index(np.argmin(np.where(np.isnan(room), -np.inf, room)), room.shape)
    names = [*map(str, np.ravel(form.coefficient_names)), *(axis.symbol for axis in form.axes)]
    (text,) = formulas(subprogram(program, [tried[column]]), names)
    what = f"{text} " if len(text) <= _LONGEST else "it "
    where = ", ".join(
        f"{axis.name} = {value:.6g}" for axis, value in zip(form.axes, points[row], strict=True)
    )
    return (
        f"{called[tried[column]]} that is not shown to be positive on its whole domain: "
        f"{what}is {values[row, column]:.3g} at {where}"
    )
