"""Programs as data: evaluation with NumPy and with other numbers, and parts of programs."""

import tracemalloc

import jax.numpy as jnp
import numpy as np
import pytest

from programs import program as program_module
from programs.functions import Function, Parameter
from programs.program import Program, Step, evaluate, interpret, reachable_values, subprogram
from programs.tracing.tracer import trace


def of_scalars(call, names: str = "x", result=None) -> Function:
    """Make a function of scalars with these names from a JAX callable."""
    parameters = tuple(Parameter(name, (-1.0, 1.0)) for name in names.split())
    return Function("Example", "An example.", parameters, result, "results", call)


def test_every_operation_is_rounded_to_half():
    function = of_scalars(lambda x, y: jnp.sqrt(x * y + 0.1) / 3.0, "x y")
    rows = np.random.default_rng(3).uniform(0, 1, (200, 2))
    x, y = rows.astype(np.float16).T
    product = (x.astype(np.float64) * y).astype(np.float16)
    total = (product.astype(np.float64) + np.float16(0.1)).astype(np.float16)
    root = np.sqrt(total.astype(np.float64)).astype(np.float16)
    expected = (root.astype(np.float64) / 3.0).astype(np.float16)
    given_back = evaluate(trace(function), rows, np.float16)
    assert given_back.dtype == np.float16
    np.testing.assert_array_equal(given_back[:, 0], expected)


def test_a_constant_result_is_repeated_for_every_point():
    values = evaluate(trace(of_scalars(lambda x: (x, jnp.asarray(0.25)), "x", 2)), np.ones((3, 1)))
    np.testing.assert_array_equal(values, [[1.0, 0.25]] * 3)


def test_a_program_can_be_interpreted_with_intervals():
    program = trace(of_scalars(lambda x, y: x * y - 0.5, "x y"))
    table = {
        "mul": lambda a, b: (
            min(p * q for p in a for q in b),
            max(p * q for p in a for q in b),
        ),
        "sub": lambda a, b: (a[0] - b[1], a[1] - b[0]),
    }
    assert interpret(program, [(1.0, 2.0), (-3.0, 4.0)], table, lambda c: (c, c)) == ((-6.5, 7.5),)
    with pytest.raises(ValueError, match="operation 'sub' in Example has no meaning here"):
        interpret(program, [1.0, 1.0], {"mul": lambda a, b: a * b}, float)


@pytest.mark.parametrize("shape", [(3,), (3, 2), (3, 1, 1)])
def test_inputs_of_another_shape_are_refused(shape):
    with pytest.raises(ValueError, match="inputs"):
        evaluate(trace(of_scalars(jnp.sin)), np.zeros(shape))


def test_a_program_is_plain_data():
    program = trace(of_scalars(lambda x: x + 1.0))
    assert program == Program("Example", ("x",), (Step("add", (0, 1.0)),), (1,))
    assert {program: 1}[program] == 1


# Inputs x and y; then the values x·y, sin(x·y), y + 1 and y − (y + 1).
STEPS = (
    Step("mul", (0, 1)),
    Step("sin", (2,), "wave"),
    Step("add", (1, 1.0)),
    Step("sub", (1, 4)),
)
WHOLE = Program("Whole", ("x", "y"), STEPS, (3, 5))


def test_reachable_values_are_those_that_an_output_depends_on():
    assert reachable_values(WHOLE) == {0, 1, 2, 3, 4, 5}
    assert reachable_values(Program("Part", ("x", "y"), STEPS, (5, 0.5))) == {1, 4, 5}
    assert reachable_values(Program("Constant", ("x", "y"), STEPS, (True, 0.5))) == set()


def test_a_subprogram_has_the_needed_steps_only_and_all_inputs():
    part = subprogram(WHOLE, [5, 0.25])
    assert part.inputs == WHOLE.inputs
    assert part.steps == (Step("add", (1, 1.0)), Step("sub", (1, 2)))
    assert part.outputs == (3, 0.25)
    assert subprogram(WHOLE, [3]).steps == STEPS[:2]
    rows = np.array([[0.5, 2.0], [1.0, -3.0]])
    np.testing.assert_array_equal(evaluate(part, rows)[:, 0], evaluate(WHOLE, rows)[:, 1])


def chain(length: int) -> Program:
    """A program whose steps are all needed at the end of it, and one output that is constant."""
    steps = [Step("sin", (0,)), *(Step("mul", (k, 0.9999)) for k in range(1, length - 1))]
    return Program("chain", ("x",), (*steps, Step("add", (length - 1, 1))), (length, 2.5, 0))


def test_points_are_evaluated_in_parts_of_bounded_memory(monkeypatch):
    # All steps at all points would take 32 MiB.
    monkeypatch.setattr(program_module, "_BYTES", 1 << 22)
    points = np.random.default_rng(0).random((1 << 15, 1))
    tracemalloc.start()
    found = evaluate(chain(128), points)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 8 << 20
    assert found.shape == (1 << 15, 3)
    assert np.all(found[:, 1] == 2.5) and np.array_equal(found[:, 2], points[:, 0])


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64])
def test_parts_have_the_values_of_the_whole(monkeypatch, dtype):
    points = np.random.default_rng(0).normal(size=(101, 1))
    whole = evaluate(chain(20), points, dtype)
    monkeypatch.setattr(program_module, "_BYTES", 0)
    np.testing.assert_array_equal(evaluate(chain(20), points, dtype), whole)
    monkeypatch.setattr(program_module, "_LEAST_ROWS", 7)
    np.testing.assert_array_equal(evaluate(chain(20), points, dtype), whole)
    assert whole.dtype == dtype
