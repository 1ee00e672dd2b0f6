"""Functions and their parameters: names of inputs, and what is refused."""

import jax.numpy as jnp
import pytest

from programs import functions
from programs.functions import Function, Parameter, group_inputs, input_names
from programs.tracing.tracer import trace


def of_scalars(call, names: str = "x", result=None) -> Function:
    """Make a function of scalars with these names from a JAX callable."""
    parameters = tuple(Parameter(name, (-1.0, 1.0)) for name in names.split())
    return Function("Example", "An example.", parameters, result, "results", call)


def test_inputs_are_named_and_grouped():
    parameters = (Parameter("c", (0.0, 1.0), size=2), Parameter("x", (0.0, 1.0)))
    function = Function("F", "F.", parameters, None, "r", lambda c, x: c[0] + c[1] * x)
    assert input_names(function) == ("c[0]", "c[1]", "x")
    assert group_inputs(function, [1, 2, 3]) == ((1, 2), 3)
    assert trace(function).inputs == ("c[0]", "c[1]", "x")
    with pytest.raises(ValueError, match="F was given 2 inputs; allowed: 3"):
        group_inputs(function, [1, 2])


INVALID = {
    "no identifier": lambda: Parameter("2x", (0.0, 1.0)),
    "Greek": lambda: Parameter("θ", (0.0, 1.0)),
    "empty domain": lambda: Parameter("x", (1.0, 0.0)),
    "infinite domain": lambda: Parameter("x", (0.0, float("inf"))),
    "no domain": lambda: Parameter("x", (float("nan"), 1.0)),
    "no size": lambda: Parameter("x", (0.0, 1.0), size=0),
    "no result": lambda: Function("F", "F.", (), 0, "r", lambda: ()),
    "function name": lambda: Function("a b", "F.", (), None, "r", lambda: 0.0),
    "twice": lambda: of_scalars(jnp.add, "x x"),
    "result is input": lambda: Function(
        "F", "", (Parameter("r", (0.0, 1.0)),), 1, "r", lambda r: (r,)
    ),
}


@pytest.mark.parametrize("name", INVALID)
def test_an_invalid_function_or_parameter_is_refused(name):
    with pytest.raises(ValueError, match="allowed: "):
        INVALID[name]()


def test_the_short_way_to_make_a_function_has_defaults():
    parameters = [Parameter("x", (0.0, 1.0))]
    made = functions.function("F", parameters, jnp.sin)
    assert made == Function("F", "F.", tuple(parameters), None, "result", jnp.sin)
    pair = functions.function("F", parameters, jnp.sin, "Two values.", 2, "values")
    assert (pair.summary, pair.result, pair.result_name) == ("Two values.", 2, "values")
