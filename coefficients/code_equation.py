"""The equation of an entry with the names of its exported code, for the comment above the code."""

import re

from coefficients.catalogue import Entry
from fitting.equation import coefficient_symbols, with_names


def code_equation(entry: Entry) -> str:
    """Return the equation of an entry, in which the arguments are called as in the exported code.

    It says which names are coefficients. The equation of a closed form is returned as it is.
    """
    if entry.fitted is None:
        return entry.equation
    form, calling = entry.fitted.form, entry.problem.calling
    symbols = {axis.name: axis.symbol for axis in form.axes}
    names = {symbols[each.axis]: _written(each, calling.cosines) for each in calling.arguments}
    directed = [name for name, _ in calling.second] if form.inputs is not None else []
    text = with_names(form.equation, names, directed)
    # The cosine of the angle whose cosine is NdotT is NdotT.
    text = re.sub(r"cos\(acos\((\w+)\)\)", r"\1", text)
    where = f" ({form.printed} of the supplement)" if form.printed else ""
    return f"{text}{where}{_coefficients(entry)}"


def _written(argument, cosines: bool) -> str:
    """Return how an equation writes an angle or number that is an argument of the code."""
    if cosines and argument.cosine is not None:
        return f"acos({argument.cosine})"
    return argument.name


def _coefficients(entry: Entry) -> str:
    symbols = coefficient_symbols(entry.require_table().coefficient_names)
    if not symbols:
        return f"; table {entry.name} has no coefficients"
    if symbols[0].startswith("C["):
        return f"; C[0], C[1], ... are the coefficients of table {entry.name} in order"
    known = "is the coefficient" if len(symbols) == 1 else "are the coefficients"
    return f"; {', '.join(symbols)} {known} of table {entry.name}"
