"""Certificates have no loopholes: no form with a pole, overflow or NaN in its box is certified."""

import itertools

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from programs.bounding.denominators import operands, prove_no_pole
from programs.functions import Function, Parameter
from programs.program import evaluate, subprogram
from programs.tracing.tracer import trace
from tests.programs.test_interval import INPUTS, RECIPES, built, exactly

BOX = np.array([[0.0, 1.0], [-1.0, 2.0]])
ZERO = np.float64(0.0)


def program_of(call):
    parameters = tuple(Parameter(name, (-1.0, 1.0)) for name in "xy")
    function = Function("Example", "An example.", parameters, None, "value", call)
    return trace(function, keep_undefined=True)


# Expressions on x in [0, 1], y in [−1, 2] that are undefined or overflow somewhere in the box
FAULTS = {
    "divisor 0 at an end": lambda x, y: 1 / x,
    "divisor 0 inside": lambda x, y: x / (y - 0.3),
    "divisor a constant 0": lambda x, y: x / ZERO,
    "quotient of constants": lambda x, y: x + jnp.divide(1.0, ZERO),
    "reciprocal of a folded pole": lambda x, y: x + 1 / jnp.divide(1.0, ZERO),
    "root of a negative constant": lambda x, y: x + jnp.sqrt(ZERO - 1),
    "logarithm of a constant 0": lambda x, y: x + 1 / jnp.log(ZERO),
    "root just below zero": lambda x, y: jnp.sqrt(x - 1e-301),
    "root below zero at one point": lambda x, y: jnp.sqrt((y - 0.3) ** 2 - 1e-12),
    "logarithm of zero": lambda x, y: jnp.log(x * x),
    "log1p of −1": lambda x, y: jnp.log1p(y),
    "rsqrt of zero": lambda x, y: 1 / jnp.sqrt(x * x * x),
    "overflow of exp": lambda x, y: jnp.exp(800 * x),
    "overflow over overflow": lambda x, y: jnp.exp(800 * x) / (1 + jnp.exp(800 * x)),
    "overflow of a product": lambda x, y: (1e200 * (1 + x)) * (1e200 * (1 + x)),
    "overflow of cosh": lambda x, y: jnp.cosh(1000 * y),
    "underflow of a divisor": lambda x, y: 1 / jnp.exp(-900 * x),
    "overflow of a quotient": lambda x, y: 1e10 / (x + 1e-300),
    "tangent at π/2": lambda x, y: jnp.tan(y),
    "arcsine above 1": lambda x, y: jnp.arcsin(y),
    "arccosine below −1": lambda x, y: jnp.arccos(y - 0.5),
    "angle of (0, 0)": lambda x, y: jnp.arctan2(y, x),
    "power of a negative number": lambda x, y: jnp.power(y, 0.5),
    "negative power of zero": lambda x, y: jnp.power(x, -1.5),
    "power of zero to a negative variable": jnp.power,
    "not a number": lambda x, y: x + np.nan,
}
# What may hide the fault from the result
HIDDEN = {
    "as it is": lambda fault, x, y: fault,
    "times zero": lambda fault, x, y: x + fault * 0.0,
    "times a constant zero": lambda fault, x, y: x + ZERO * fault,
    "cut to a range": lambda fault, x, y: jnp.minimum(jnp.maximum(fault, 0.0), 1.0),
    "below": lambda fault, x, y: x / (1 + jnp.exp(-jnp.maximum(fault, -1.0))),
    "not selected": lambda fault, x, y: jnp.where(x < 2, x, fault),
}
FORMS = list(itertools.product(FAULTS, HIDDEN))


def test_there_are_more_than_a_hundred_forms():
    assert len(FORMS) > 100


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy warns of what the forms do
@pytest.mark.parametrize(("fault", "hidden"), FORMS)
def test_a_form_with_a_fault_is_not_certified(fault, hidden):
    program = program_of(lambda x, y: HIDDEN[hidden](FAULTS[fault](x, y), x, y))
    assert not prove_no_pole(program, BOX).holds


# The same operations where they are defined, with operands that reach the ends of their domains
SOUND = {
    "divisor a negative constant": lambda x, y: x / np.float64(-3.0),
    "divisor below from zero": lambda x, y: 1 / (x + 1e-3),
    "root that is zero at an end": lambda x, y: jnp.sqrt(1 - x * x) + jnp.sqrt((1 - x) * (1 + x)),
    "root that is zero at both ends": lambda x, y: jnp.sqrt(x * (1 - x)),
    "root of a product with zero": lambda x, y: jnp.sqrt(x * (y + 1)),
    "log1p": lambda x, y: jnp.log1p(y + 0.5),
    "exponential": lambda x, y: jnp.exp(300 * y),
    "quotient of exponentials": lambda x, y: jnp.exp(300 * y) / (1 + jnp.exp(300 * y)),
    "tangent": lambda x, y: jnp.tan(0.7 * y) + jnp.tan(x + 1.6),
    "arcs": lambda x, y: jnp.arcsin(x) + jnp.arccos(jnp.minimum(y, 1.0)) + jnp.arctan(y),
    "angle": lambda x, y: jnp.arctan2(y, x + 0.1),
    "power": lambda x, y: jnp.power(x, 2.5) + jnp.power(y + 1.5, y),
    "hyperbolic": lambda x, y: jnp.cosh(y) + jnp.sinh(y) + jnp.tanh(y),
    "steps": lambda x, y: jnp.floor(3 * x) + jnp.ceil(y) + jnp.abs(y),
    "infinite limit": lambda x, y: 1 / jnp.maximum(x + 0.1, -np.inf),
    "quotient of large numbers": lambda x, y: (1e300 * x) / (1e300 * (1 + x)),
}


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_form_is_certified(name):
    program = program_of(SOUND[name])
    found = prove_no_pole(program, BOX)
    assert found.holds
    points = np.random.default_rng(1).uniform(*BOX.T, (1000, 2))
    corners = np.array(list(itertools.product(*BOX)))
    assert np.isfinite(evaluate(program, np.concatenate([corners, points]))).all()


def test_folding_for_code_is_not_changed():
    function = Function(
        "Example", "", (Parameter("x", (0.0, 1.0)),), None, "value", lambda x: x + ZERO / (x - 0.5)
    )
    assert len(trace(function).steps) == len(trace(function, keep_undefined=True).steps)
    product = Function(
        "Example", "", (Parameter("x", (0.0, 1.0)),), None, "value", lambda x: x + ZERO * (1 / x)
    )
    assert trace(product).steps == ()
    assert [step.operation for step in trace(product, keep_undefined=True).steps] == [
        *("div", "mul", "add"),
    ]


@settings(max_examples=80, deadline=None)
@given(
    recipe=RECIPES,
    corner=st.tuples(*[st.floats(-3, 3)] * INPUTS),
    size=st.tuples(*[st.sampled_from([1e-9, 0.03, 0.6, 3.0])] * INPUTS),
    places=st.lists(st.tuples(*[st.floats(0, 1)] * INPUTS), min_size=8, max_size=8),
)
@pytest.mark.slow
def test_what_is_certified_is_defined_wherever_it_is_evaluated(recipe, corner, size, places):
    program = built(recipe)
    box = np.stack([corner, np.array(corner) + size], axis=1)
    try:
        found = prove_no_pole(program, box)
    except ValueError:
        pytest.fail("every operation has an interval version")
    if not found.holds:
        return
    points = np.concatenate(
        [np.array(list(itertools.product(*box))), box[:, 0] + np.array(places) * np.diff(box).T]
    )
    points = np.clip(points, *box.T)
    assert np.isfinite(evaluate(program, points)).all()
    divisors = operands(program, "div", 1)
    if divisors:
        sizes = np.abs(evaluate(subprogram(program, divisors), points))
        assert sizes.min() >= found.bound * (1 - 1e-9)
    for point in points:
        exact = exactly(program, point)
        # Where the slope is infinite, such as that of a root at zero, `exactly` gives None.
        if exact is not None:
            assert mpmath.isfinite(exact.value)
