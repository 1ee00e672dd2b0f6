"""Programs as formulas for people to read."""

import jax.numpy as jnp
import pytest

from programs.functions import Function, Parameter
from programs.printing.formula import formulas
from programs.tracing.tracer import trace


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda x, y: x * (1 + 2.5 * x * x) / (1 - y), "x·(1 + 2.5·x·x)/(1 − y)"),
        (lambda x, y: x - (y - 1), "x − (y − 1)"),
        (lambda x, y: x / (y / 3), "x/(y/3)"),
        (lambda x, y: -(x + y) * y, "−(x + y)·y"),
        (lambda x, y: x * x, "x²"),
        (lambda x, y: jnp.exp(-x) + jnp.maximum(x, y), "exp(−x) + max(x, y)"),
    ],
)
def test_a_program_is_written_as_a_formula(call, text):
    parameters = (Parameter("a", (0.0, 1.0)), Parameter("b", (0.0, 1.0)))
    program = trace(Function("f", "", parameters, None, "v", call))
    assert formulas(program, ["x", "y"]) == [text]
