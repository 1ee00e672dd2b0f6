"""A program as one formula, for people to read."""

import re
from collections.abc import Sequence

from programs.languages import language
from programs.printing.expression import WritingContext, expression
from programs.printing.line_breaking import on_one_line
from programs.program import Program


def formula(program: Program, names: Sequence[str]) -> str:
    """Return a program of one output as a formula, such as 'x * (a + b * x) / (1 + c * x)'.

    `names` are those of the inputs in the formula. A value that is used twice is written twice.
    """
    context = WritingContext(program, language("python"), "double", dict(enumerate(names)))
    text = on_one_line(expression(context, program.outputs[0]))
    return re.sub(r"\b(\d+)\.0\b(?![e\d])", r"\1", text.replace("np.", ""))
