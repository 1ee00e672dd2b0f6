"""A form as data: the steps that compute its value, as a table's `expression` has them.

A step is a list: an operation (`programs/operations.py`), then its operands. An operand is a number
or a name: that of an axis; `c0`, `c1`, … for the flat coefficients; `t0`, `t1`, … for the results
of the steps, in order. `value` is the operand that is the form's value.
"""

import re

import jax.numpy as jnp
import numpy as np

from coefficients.table import Table
from coefficients.table_parts import Expression
from fitting.form import Form, Stage
from fitting.linearity import program_of
from integrals.reference import Axis, Reference
from integrals.sampling import Sampling
from programs.jax_operations import JAX_OPERATIONS
from programs.operations import OPERATIONS
from programs.program import Program, Step, evaluate, interpret, is_value

# A table and the form that it names may differ by this much, relative to the value.
_ROUNDING = 1e-9
# The two are compared at this many points.
_TRIED = 64
# The types of the operands of operations that take conditions: "b", and "r" for real numbers.
_CONDITIONS = {"and": "bb", "or": "bb", "not": "b", "select": "brr"}


def expression_of(form: Form) -> Expression:
    """Return the steps of a form. Raises ValueError for an axis whose name means something else."""
    program, names = program_of(form), [axis.name for axis in form.axes]
    for name in names:
        if re.fullmatch(r"[ct]\d+", name):
            raise ValueError(f"axis {name!r}: allowed are names other than c0, t0 and the like")
    known = [f"c{k}" for k in range(form.size)] + names
    known += [f"t{k}" for k in range(len(program.steps))]

    def written(operand: int | float) -> str | float:
        return known[operand] if is_value(operand) else float(operand)

    steps = [[step.operation, *map(written, step.operands)] for step in program.steps]
    return Expression(steps=steps, value=written(program.outputs[0]))


def program_from(table: Table) -> Program:
    """Return the program of a table's expression: inputs are the coefficients, then the axes.

    Raises ValueError for an operation that is not known, a wrong number or type of operands, and an
    operand that is not an earlier name.
    """
    expression, axes = table.expression, [each.name for each in table.arguments]
    assert expression is not None
    inputs = [*(f"c{k}" for k in range(table.size)), *axes]
    numbers = {name: k for k, name in enumerate(inputs)}
    if len(numbers) < len(inputs):
        raise ValueError(f"{table.name}: two arguments of the expression have one name")
    kinds, steps = dict.fromkeys(inputs, "r"), []
    for k, (operation, *operands) in enumerate(expression.steps):
        place = f"{table.name}: step {k} of the expression"
        if operation not in OPERATIONS:
            raise ValueError(f"{place}: operation {str(operation)[:20]!r} is not known")
        wanted = _CONDITIONS.get(str(operation), "r" * OPERATIONS[str(operation)].arity)
        for operand in operands:
            if isinstance(operand, str) and operand not in numbers:
                raise ValueError(f"{place}: {operand[:20]!r} is no earlier name")
        given = "".join(kinds[each] if isinstance(each, str) else "r" for each in operands)
        if given != wanted:
            raise ValueError(f"{place}: {operation} cannot take these {len(operands)} operands")
        found = (numbers[each] if isinstance(each, str) else float(each) for each in operands)
        steps.append(Step(str(operation), tuple(found)))
        name = f"t{k}"
        if name in numbers:
            raise ValueError(f"{place}: an argument is called {name}")
        numbers[name] = len(inputs) + k
        kinds[name] = "b" if OPERATIONS[str(operation)].gives == "bool" else "r"
    value = expression.value
    if isinstance(value, str) and kinds.get(value) != "r":
        raise ValueError(f"{table.name}: the value {value[:20]!r} of the expression is no number")
    output = numbers[value] if isinstance(value, str) else float(value)
    return Program(table.name, tuple(inputs), tuple(steps), (output,))


def form_of(table: Table, reference: Reference) -> Form:
    """Return the form of a table's expression. Raises ValueError as `program_from` does."""
    program = program_from(table)

    def value(coefficients, *point):
        flat = jnp.ravel(jnp.asarray(coefficients))
        inputs = [*(flat[k] for k in range(table.size)), *map(jnp.asarray, point)]
        return interpret(program, inputs, JAX_OPERATIONS, jnp.asarray)[0]

    return Form(
        table.form,
        table.equation,
        reference,
        axes_of(table),
        table.coefficient_names,
        (Stage(value),),
        shape=table.shape,
    )


def axes_of(table: Table) -> tuple[Axis, ...]:
    """Return the axes that a table states."""
    return tuple(
        Axis(each.name, *each.domain, symbol=each.symbol or each.name, unit=each.unit)
        for each in table.arguments
    )


def reference_of(table: Table) -> Reference:
    """Return the reference of a quantity of which only a table is known: it has no values."""
    about = table.about
    low, high = about.codomain if about and about.codomain else (-np.inf, np.inf)
    return Reference(
        name=table.quantity,
        symbol=about.symbol if about else table.quantity,
        meaning=about.meaning if about else "",
        definition=about.definition if about else "",
        axes=axes_of(table),
        sampling=Sampling(fitted=11, checked=11, judged=11, climbs=False),
        codomain=(low, high),
    )


def require_same(table: Table, form: Form) -> None:
    """Raise ValueError unless a table's expression gives the values of `form` at some points."""
    if table.expression == expression_of(form):
        return
    columns = np.random.default_rng(0).random((len(form.axes), _TRIED))
    points = np.stack([axis.place(u) for axis, u in zip(form.axes, columns, strict=True)], axis=1)
    flat = np.ravel(np.array(table.coefficients, float))
    inputs = np.concatenate([np.tile(flat, (_TRIED, 1)), points], axis=1)
    own, other = (evaluate(each, inputs) for each in (program_from(table), program_of(form)))
    apart = np.abs(own - other) / np.maximum(np.abs(other), 1.0)
    if not np.all(apart <= _ROUNDING):
        raise ValueError(
            f"{table.name}: its expression and its form {table.form!r} give different values"
        )
