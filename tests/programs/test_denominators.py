"""Proofs that there is no pole: each pole is found, and no regular function is refused."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from programs.bounding.branch_and_bound import BranchAndBound
from programs.bounding.denominators import (
    NOWHERE_NEGATIVE,
    TIGHTNESS,
    DenominatorBound,
    bound_below,
    operands,
    prove_no_pole,
    within,
)
from programs.functions import Function, Parameter
from programs.program import Program, Step, evaluate, subprogram
from programs.tracing.tracer import trace

# α from 0.15 to 1 and θ from 0 to π/2
BOX = np.array([[0.15, 1.0], [0.0, np.pi / 2]])


def program_of(call, names: str = "at") -> Program:
    parameters = tuple(Parameter(name, (0.0, 1.0)) for name in names)
    return trace(Function("Example", "An example.", parameters, None, "value", call))


def quotient(beta: float, gamma: float, delta: float) -> Program:
    """Return the program of 1 / (1 + β (1 − α) + γ cos θ + δ sin θ)."""
    return program_of(
        lambda a, t: 1 / (1 + beta * (1 - a) + gamma * jnp.cos(t) + delta * jnp.sin(t))
    )


def sampled(program: Program, count: int) -> np.ndarray:
    """Evaluate the divisors of a program on a grid of the box, with its boundary."""
    lines = [np.linspace(*side, count) for side in BOX]
    mesh = np.stack([each.ravel() for each in np.meshgrid(*lines, indexing="ij")], axis=1)
    return evaluate(subprogram(program, operands(program, "div", 1)), mesh)


POLES = {
    "on the edge α = 0.15": quotient(-1 / 0.85, 0, 0),
    "on the edge θ = 0": quotient(0, -1, 0),
    "in a corner": quotient(-0.5 / 0.85, -0.5, 0),
    # 1 − (cos θ + sin θ)/√2 touches zero at π/4, which is a node of every grid of odd size.
    "touches zero at a node": quotient(0, -(0.5**0.5), -(0.5**0.5)),
    # 1 − cos(θ − 0.7) touches zero between nodes; rounding may leave it just above zero.
    "touches zero between nodes": quotient(0, -np.cos(0.7), -np.sin(0.7)),
    "crosses zero between nodes": quotient(0, -1.00001 * np.cos(0.7), -1.00001 * np.sin(0.7)),
    "not a number": quotient(np.nan, 0, 0),
    "in the second of two quotients": program_of(lambda a, t: 1 / (1 + a) + 1 / (a - 0.5)),
    "inside a denominator that is positive": program_of(lambda a, t: 1 / (1 + 1 / (t - 1) ** 2)),
}


@pytest.mark.parametrize("name", POLES)
def test_a_function_with_a_pole_is_refused(name):
    found = prove_no_pole(POLES[name], BOX)
    assert not found.holds
    assert found.bound == -np.inf
    # None of these reaches the limit on the number of boxes.
    assert found.boxes < 20_000


def test_sampling_would_miss_a_pole_that_the_proof_finds():
    assert sampled(POLES["crosses zero between nodes"], 65).min() > 0


def test_a_denominator_that_nearly_vanishes_is_bounded_tightly():
    # 1 − 0.9999 cos(θ − 0.7) is at least 1e-4, between the nodes.
    found = prove_no_pole(quotient(0, -0.9999 * np.cos(0.7), -0.9999 * np.sin(0.7)), BOX)
    assert found.holds
    assert TIGHTNESS * 1e-4 <= found.bound <= 1e-4 * (1 + 1e-9)


SLOPES = st.floats(0.01, 1.5) | st.floats(-1.5, -0.01)


@settings(max_examples=20, deadline=None)
@given(st.tuples(SLOPES, SLOPES, SLOPES))
def test_what_is_proven_is_positive_and_what_is_refused_is_not(slopes):
    program = quotient(*slopes)
    found, values = prove_no_pole(program, BOX), sampled(program, 101)
    # The divisor may be negative everywhere.
    least = max(values.min(), -values.max())
    if found.holds:
        assert 0.9 * TIGHTNESS * least <= found.bound <= least
    else:
        # The slope of the denominator is below 5, and the samples are 0.016 apart.
        assert least <= 5 * 0.016


def test_the_bound_is_the_least_of_all_denominators():
    program = program_of(lambda a, t: 1 / (a + 3) + 1 / (t + 0.5) + 2 / (a + 7))
    found = prove_no_pole(program, BOX)
    assert TIGHTNESS * 0.5 <= found.bound <= 0.5


def test_a_bound_that_is_enough_is_not_improved():
    program = quotient(0, -0.9999 * np.cos(0.7), -0.9999 * np.sin(0.7))
    full, enough = prove_no_pole(program, BOX), prove_no_pole(program, BOX, 1e-6)
    assert 1e-6 <= enough.bound <= 1e-4
    assert enough.boxes < full.boxes
    # A bound that is more than what is attained is never reached.
    assert prove_no_pole(program, BOX, 1.0) == full


def test_a_function_without_divisions_needs_no_boxes():
    assert prove_no_pole(program_of(lambda a, t: a * t), BOX) == DenominatorBound(np.inf, 0)


def test_a_search_that_reaches_the_limit_is_no_proof():
    program = quotient(0, -0.9999 * np.cos(0.7), -0.9999 * np.sin(0.7))
    assert prove_no_pole(program, BOX).holds
    assert not prove_no_pole(program, BOX, solver=BranchAndBound(max_boxes=10)).holds
    root = program_of(lambda a, t: jnp.sqrt(a * t - a * t + 1))
    assert not prove_no_pole(root, BOX, solver=BranchAndBound(max_boxes=0)).holds


def test_the_first_split_changes_the_boxes_but_not_the_proof():
    for program in (quotient(0.3, -0.4, -0.5), POLES["crosses zero between nodes"]):
        plain = prove_no_pole(program, BOX)
        split = prove_no_pole(program, BOX, solver=BranchAndBound(first_split=(16, 4)))
        assert split.holds == plain.holds
        assert split.boxes >= 64
    proven = prove_no_pole(
        quotient(0.3, -0.4, -0.5), BOX, solver=BranchAndBound(first_split=(16, 4))
    )
    least = sampled(quotient(0.3, -0.4, -0.5), 101).min()
    assert 0.9 * TIGHTNESS * least <= proven.bound <= least
    roots = program_of(lambda a, t: jnp.sqrt(a + t))
    assert prove_no_pole(roots, BOX, solver=BranchAndBound(first_split=(16, 4))).boxes == 64


# Functions of θ that are infinite or undefined somewhere, and functions that are not
SINGULAR = {
    "root of a negative number": lambda a, t: jnp.sqrt((t - 0.3) ** 2 - 1e-9),
    "logarithm of zero": lambda a, t: jnp.log(t),
    "quotient inside a root": lambda a, t: jnp.sqrt(1 / (t - 0.2) ** 2),
}
REGULAR = {
    "root of zero": lambda a, t: jnp.sqrt(t),
    "logarithm of a number above zero": lambda a, t: t * jnp.log(jnp.maximum(t, 1e-30)),
    "quotient whose divisor is kept from zero": lambda a, t: 1 / jnp.maximum(t - 0.2, 1e-3),
}


@pytest.mark.parametrize("name", [*SINGULAR, *REGULAR])
def test_operands_of_roots_and_logarithms_are_proven_too(name):
    found = prove_no_pole(program_of((SINGULAR | REGULAR)[name]), BOX)
    assert found.holds == (name in REGULAR)
    assert found.boxes > 0


def test_an_operation_without_an_interval_version_is_refused():
    program = Program("Example", ("a", "t"), (Step("gamma", (0,)),), (2,))
    with pytest.raises(ValueError, match=r"operation 'gamma' .* has no meaning here"):
        prove_no_pole(program, BOX)


@pytest.mark.parametrize(("lowest", "holds"), [(1e-3, True), (0.0, False), (-1e-3, False)])
def test_an_output_is_bounded_below_only_if_it_is_positive(lowest, holds):
    found = bound_below(program_of(lambda a, t: (t - 0.7) ** 2 + lowest), BOX)
    assert found.holds == holds
    if holds:
        assert TIGHTNESS * lowest <= found.bound <= lowest
    else:
        assert found.bound == -np.inf


def test_operands_are_listed_once_and_without_constants():
    steps = (
        Step("div", (1.0, 1)),
        Step("div", (1, 3.0)),
        Step("add", (0, 2)),
        Step("div", (0, 4)),
        Step("div", (3, 4)),
    )
    program = Program("Example", ("a", "t"), steps, (5, 6))
    assert operands(program, "div", 0) == [0, 1, 3]
    assert operands(program, "div", 1) == [1, 4]
    assert operands(program, "add", 1) == [2]
    assert operands(program, "log", 0) == []


def test_a_constant_divisor_hides_no_value_of_the_same_number():
    # z is value number 3, and 3.0 is a divisor too. 1/z has a pole on the boundary of the box.
    program = program_of(lambda a, t, y, z: a / 3.0 + t + y + 1 / z, "atyz")
    box = np.concatenate([BOX, [[0.0, 1.0]] * 2])
    assert operands(program, "div", 1) == [3]
    assert not prove_no_pole(program, box).holds


def test_a_box_is_settled_if_both_bounds_are_allowed():
    settled = within(NOWHERE_NEGATIVE)
    below, above = np.array([0.0, -5e-324, -1e-3]), np.array([1.0, 2.0, np.inf])
    assert settled(below, above, 0.0, 1.0).tolist() == [True, False, False]
    settled = within((0.0, 1.0))
    assert settled(np.zeros(3), np.array([1.0, 2.0, 0.5]), 0.0, 1.0).tolist() == [True, False, True]


def test_a_bound_of_zero_is_no_proof():
    assert DenominatorBound(1e-300, 1).holds
    assert not DenominatorBound(0.0, 1).holds


def test_a_divisor_that_is_negative_everywhere_is_no_pole():
    program = program_of(lambda a: 1 / (a - 3), "a")
    found = prove_no_pole(program, np.array([[0.0, 1.0]]))
    assert 1.8 <= found.bound <= 2
    across = prove_no_pole(program, np.array([[0.0, 4.0]]))
    assert not across.holds
