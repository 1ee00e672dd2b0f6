"""Graphs of MaterialX's nodes, evaluated by what MaterialX's specification says of each node."""

import jax.numpy as jnp
import numpy as np
import pytest

from programs import Parameter, evaluate, function, trace
from programs.printing.node_graph import node_graph
from tests.standard_nodes import evaluate_nodes

X, Y = Parameter("x", (-2.0, 2.0)), Parameter("y", (-2.0, 2.0))
POINTS = np.random.default_rng(3).uniform(-2, 2, (200, 2))
# Each has an operation, or a way to combine them, that the others have not.
CALLS = {
    "arithmetic": lambda x, y: (x + y * x - y) / (y * y + 1.0) - (-x),
    "roots": lambda x, y: jnp.sqrt(x * x + 0.1) + 1.0 / jnp.sqrt(y * y + 0.1),
    "ends": lambda x, y: jnp.minimum(jnp.floor(x), y) + jnp.maximum(jnp.ceil(y), jnp.abs(x)),
    "greater": lambda x, y: jnp.where(x > y, x, 3.0) + jnp.where(x >= 0.5, 1.0, y),
    "less": lambda x, y: jnp.where(x < y, x, 3.0) + jnp.where(x <= 0.5, 1.0, y),
    "logic": lambda x, y: jnp.where((x < 0) & (y < 1) | ~(x < 1), x, y),
    "powers": lambda x, y: jnp.exp(x) + jnp.exp2(y) + jnp.log(x * x + 1.0) + jnp.exp(x) ** y,
    "small": lambda x, y: jnp.expm1(x / 100) + jnp.log1p(y / 100),
    "angles": lambda x, y: jnp.sin(x) + jnp.cos(y) + jnp.tan(x / 2) + jnp.arctan2(x, y),
    "inverse": lambda x, y: jnp.arcsin(x / 2) + jnp.arccos(y / 2) + jnp.arctan(x),
}


@pytest.mark.parametrize("name", CALLS)
def test_nodes_compute_what_the_program_does(name):
    whole = function("Whole", [X, Y], CALLS[name])
    expected = evaluate(trace(whole), POINTS)[:, 0]
    nodes, value = node_graph([whole])
    given = evaluate_nodes(nodes, value, dict(zip("xy", POINTS.T, strict=True)))
    # Constants are rounded to float32.
    np.testing.assert_allclose(given, expected, rtol=1e-5, atol=1e-6)


def test_results_of_a_function_are_the_first_inputs_of_the_next():
    first = function("First", [X], lambda x: (x + 1.0, x - 2.0), result=2)
    second = function(
        "Second", [Parameter("c", (-9.0, 9.0), size=2), Y], lambda c, y: c[0] * y - c[1]
    )
    nodes, value = node_graph([first, second])
    given = evaluate_nodes(nodes, value, {"x": 3.0, "y": 5.0})
    assert given == 4.0 * 5.0 - 1.0


@pytest.mark.parametrize("constant", [1e-30, -7e-4, 0.1, 1 / 3, -np.pi, 17.3, 123456.7, 3e10])
def test_constants_keep_their_digits_with_six_decimals(constant):
    nodes, value = node_graph([function("Sum", [X], lambda x: x * constant)])
    held = [source for node in nodes for _, source in node.inputs if isinstance(source, float)]
    assert held
    assert all(np.float32(f"{each:.6f}") == np.float32(each) for each in held)
    assert np.float32(evaluate_nodes(nodes, value, {"x": 1.0})) == np.float32(constant)


def test_an_operation_without_a_node_is_refused():
    with pytest.raises(ValueError, match="operation 'tanh' in Soft is no node of MaterialX"):
        node_graph([function("Soft", [X], jnp.tanh)])
