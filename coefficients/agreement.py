"""From a table to its form: what the table states about the form has to be true."""

import reprlib
from typing import Any

import numpy as np

from coefficients.table import Table
from fitting import FittedForm, Form
from quantities import Problem

# Domains that differ by less are equal: a file may state them in float32 or with seven digits.
ROUNDING = 1e-6
# A proven bound of values may be this far outside the codomain, because the proof rounds outwards.
ROUNDING_OF_PROOF = 1e-11


def fitted_form(table: Table, owner: Problem) -> FittedForm:
    """Return the form of a table with the table's coefficients.

    `owner` is the table's quantity. Raises ValueError if it has no such form, or if the shape of
    the coefficients, their names, or the arguments differ from those of the form.
    """
    form = owner.find_form(table.form, table.shape)
    coefficients = np.array(table.coefficients)
    if coefficients.shape != form.coefficient_shape:
        raise ValueError(
            f"{table.name} has coefficients of shape {coefficients.shape}, "
            f"form {table.form!r} takes {form.coefficient_shape}"
        )
    _require_agreement(table, form)
    return form.fitted(coefficients)


def _require_agreement(table: Table, form: Form) -> None:
    """Raise ValueError if a table states its form's arguments, weight or names differently."""
    given = {each.name: (each.unit, each.domain) for each in table.arguments}
    wanted = {axis.name: (axis.unit, [axis.lower, axis.upper]) for axis in form.axes}
    if [each.name for each in table.arguments] != list(wanted):
        raise _contradiction(table, "arguments", list(given), list(wanted))
    for name, (unit, domain) in wanted.items():
        its_unit, its_domain = given[name]
        if its_unit != unit:
            raise _contradiction(table, f"the unit of {name}", its_unit, unit)
        if not np.allclose(its_domain, domain, ROUNDING, ROUNDING):
            raise _contradiction(table, f"the domain of {name}", its_domain, domain)
    certificates, (least, most) = table.certificates, form.reference.codomain
    if certificates is not None and certificates.range is not None:
        lower, upper = certificates.range
        if not least - ROUNDING_OF_PROOF <= lower <= upper <= most + ROUNDING_OF_PROOF:
            raise _contradiction(table, "the range", [lower, upper], [least, most])
    measures = list(form.reference.sampling.measures)
    if table.weight is not None and table.weight not in measures:
        raise _contradiction(table, "the weight", table.weight, measures)
    names = np.ravel(np.array(table.coefficient_names, dtype=object))
    expected = np.ravel(np.array(form.coefficient_names, dtype=object))
    for index, (its_name, name) in enumerate(zip(names, expected, strict=True)):
        if its_name != name:
            raise _contradiction(table, f"the name of coefficient {index}", its_name, name)


def _contradiction(table: Table, what: str, given: Any, wanted: Any) -> ValueError:
    # The value may come from a file and be long: only a part is shown.
    return ValueError(
        f"{table.name} gives {what} as {reprlib.repr(given)}, "
        f"form {table.form!r} has {reprlib.repr(wanted)}"
    )
