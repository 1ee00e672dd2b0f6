"""Cost: operations are counted by kind."""

from dataclasses import fields

import jax.numpy as jnp
import pytest

from programs.cost import KINDS, WEIGHTS, Cost, count_operations
from programs.functions import Function, Parameter
from programs.operations import OPERATIONS
from programs.tracing.tracer import trace
from tests.programs.toys import ARRAYS, SCALAR, UNIT


def of_x(call):
    return trace(Function("Example", "E.", (Parameter("x", UNIT),), None, "result", call))


COUNTS = {
    "Horner": (lambda x: 0.5 + x * (0.25 + x * (2.0 + x)), Cost(add=3, mul=2, fma=2)),
    "shared product": (lambda x: (x * x + 1.0) * (x * x - 2.0), Cost(add=2, mul=2)),
    "quotient": (lambda x: x / (1.0 + x), Cost(add=1, div=1)),
    "two products": (lambda x: x * x + 3.0 * x, Cost(add=1, mul=2, fma=1)),
    "root": (lambda x: jnp.sqrt(-x), Cost(sqrt=1, sign=1)),
    "clamp": (lambda x: jnp.clip(x, 0.1, 0.5), Cost(select=2)),
    "choice": (lambda x: jnp.where(x > 0.0, x, 1.0), Cost(select=2)),
    "functions": (lambda x: jnp.sin(x) * jnp.power(x, 0.3), Cost(mul=1, transcendental=2)),
    "nothing": (lambda x: x, Cost()),
    "constant": (lambda x: jnp.asarray(0.5) * 2.0, Cost()),
}


@pytest.mark.parametrize("name", COUNTS)
def test_operations_are_counted_by_kind(name):
    call, expected = COUNTS[name]
    assert count_operations(of_x(call)) == expected


def test_totals_are_sums_over_the_kinds():
    each = Cost(add=1, mul=1, div=1, sqrt=1, transcendental=1, select=1, sign=1, fma=1)
    assert each.operations == 6
    assert each.weighted == sum(WEIGHTS.values())
    assert Cost(div=2, sign=5).weighted == 2 * WEIGHTS["div"]


def test_only_operations_on_varying_inputs_are_counted():
    program = trace(SCALAR)
    assert count_operations(program) == Cost(add=3, mul=3, div=1, sqrt=1, fma=3)
    assert count_operations(program, ["alpha"]) == Cost(add=2, mul=2, div=1, fma=2)
    assert count_operations(program, ["alpha", "d"]) == count_operations(program)
    assert count_operations(program, []) == Cost()
    arrays = trace(ARRAYS)
    assert count_operations(arrays, ["x"]) == Cost(add=1, mul=2, fma=1)
    assert (
        count_operations(arrays, ["c[1]"]).transcendental
        == count_operations(arrays, ["c"]).transcendental
        == 1
    )
    assert count_operations(arrays, ["c[0]"]) == Cost(add=1, fma=1)


def test_an_unknown_input_is_refused():
    with pytest.raises(ValueError, match="'beta' is no input of Rational; allowed: alpha, d"):
        count_operations(trace(SCALAR), ["beta"])


def test_every_operation_has_a_kind_and_every_kind_a_field():
    assert [field.name for field in fields(Cost)] == [*KINDS, "fma"]
    assert {operation.kind for operation in OPERATIONS.values()} == set(KINDS)
