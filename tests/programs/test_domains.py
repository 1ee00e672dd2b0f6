"""Proofs for programs of a few steps: at the ends of each domain, and one number beyond them."""

import numpy as np
import pytest

from programs.bounding import denominators
from programs.bounding.denominators import prove_no_pole
from programs.program import Operand, Program, Step

INF, NAN = np.inf, np.nan
SMALLEST, ULP = 5e-324, 2.0**-52
BELOW_ONE, NEAR_ONE = 1 - ULP / 2, (0.5, 1.0)


def proven(steps, *sides: tuple[float, float], outputs: tuple[Operand, ...] | None = None):
    """Try to prove that steps on a box have no pole. The first step is value number 2."""
    box = np.array([*sides, NEAR_ONE, NEAR_ONE][:2])
    outputs = (len(steps) + 1,) if outputs is None else outputs
    program = Program("Example", ("x", "y"), tuple(Step(*each) for each in steps), outputs)
    with np.errstate(all="ignore"):
        return prove_no_pole(program, box)


# Steps, sides of the box, and whether they are defined and finite on all of it
DEFINED = {
    "root from zero": ([("sqrt", (0,))], (0.0, 1.0)),
    "logarithm": ([("log", (0,))], (SMALLEST, 1.0)),
    "reciprocal root": ([("rsqrt", (0,))], (SMALLEST, 1.0)),
    "log1p": ([("log1p", (0,))], (-BELOW_ONE, 1.0)),
    "arcsine": ([("asin", (0,))], (-1.0, 1.0)),
    "arccosine": ([("acos", (0,))], (-1.0, 1.0)),
    "tangent": ([("tan", (0,))], (-1.5, 1.57)),
    "tangent of a larger number": ([("add", (0, 1.0)), ("tan", (2,))], (0.6, 3.7)),
    "square by a power": ([("pow", (0, 2.0))], (0.0, 1.0)),
    "root by a power": ([("pow", (0, 0.5))], (0.0, 1.0)),
    "inverse by a power": ([("pow", (0, -0.5))], (1e-9, 1.0)),
    "power of two numbers": ([("pow", (0, 1))], (0.5, 1.0), (-1.0, 1.0)),
    "power of a constant": ([("pow", (0.5, 0))], (-1.0, 1.0)),
    "angle on the right": ([("atan2", (1, 0))], (0.5, 1.0), (-1.0, 1.0)),
    "angle above": ([("atan2", (1, 0))], (-1.0, 1.0), (0.5, 1.0)),
    "angle to a constant": ([("atan2", (0, 1.0))], (-1.0, 1.0)),
    "quotient by the first input": ([("div", (1.0, 0))], (1e-9, 1.0)),
    "quotient by a constant": ([("div", (0, 1.0))], (-1.0, 1.0)),
    "quotient of an infinite limit": ([("max", (0, -INF)), ("div", (1.0, 2))], (0.5, 1.0)),
    "divisor below one": ([("div", (0, 1))], (-1.0, 1.0), (0.1, 0.6)),
    "divisor above minus one": ([("div", (0, 1))], (-1.0, 1.0), (-0.6, -0.1)),
    "negative divisor, first side elsewhere": ([("div", (0, 1))], (10.0, 20.0), (-2.0, -1.0)),
    # Its natural bounds overflow, but x (1 − x) is at most ¼.
    "exponential of a parabola": (
        [("sub", (1.0, 0)), ("mul", (0, 2)), ("mul", (3, 2500.0)), ("exp", (4,)), ("sqrt", (5,))],
        (0.0, 1.0),
    ),
    "product of two large numbers": ([("mul", (0, 1))], (-1e150, 1e150), (0.0, 1e150)),
}
UNDEFINED = {
    "root below zero": ([("sqrt", (0,))], (-SMALLEST, 1.0)),
    "logarithm of zero": ([("log", (0,))], (0.0, 1.0)),
    "reciprocal root of zero": ([("rsqrt", (0,))], (0.0, 1.0)),
    "log1p of minus one": ([("log1p", (0,))], (-1.0, 1.0)),
    "arcsine above one": ([("asin", (0,))], (-1.0, 1.0 + ULP)),
    "arcsine below minus one": ([("asin", (0,))], (-1.0 - ULP, 1.0)),
    "arccosine above one": ([("acos", (0,))], (-1.0, 1.0 + ULP)),
    "arccosine below minus one": ([("acos", (0,))], (-1.0 - ULP, 1.0)),
    "tangent": ([("tan", (0,))], (-1.5, 1.6)),
    "power of a negative number": ([("pow", (0, 2.5))], (-SMALLEST, 1.0)),
    "inverse of zero by a power": ([("pow", (0, -0.5))], (0.0, 1.0)),
    "power of zero": ([("pow", (0, 1))], (0.0, 1.0), (-1.0, 1.0)),
    # It is zero, but the logarithm of zero has no bounds.
    "power of zero to a positive number": ([("pow", (0, 1))], (0.0, 1.0), (0.5, 1.0)),
    "power of a constant zero": ([("pow", (0.0, 0))], (1.0, 2.0)),
    "power of a negative constant": ([("pow", (-0.5, 0))], (1.0, 2.0)),
    "angle of the origin": ([("atan2", (1, 0))], (-1.0, 1.0), (-1.0, 1.0)),
    "angle of a corner": ([("atan2", (1, 0))], (0.0, 1.0), (0.0, 1.0)),
    "angle to a constant zero": ([("atan2", (0, 0.0))], (-1.0, 2.0)),
    "pole in a corner": ([("add", (0, 1)), ("div", (1.0, 2))], (0.0, 1.0), (0.0, 1.0)),
    "pole on an edge": ([("mul", (0, 1)), ("div", (1.0, 2))], (0.5, 1.0), (0.0, 1.0)),
    # The divisor is negative, and nowhere above −1: the exponent is up to 1000.
    "overflow beside a negative divisor": (
        [("sub", (0, 2.0)), ("div", (1.0, 2)), ("mul", (2, -1000.0)), ("exp", (4,))],
        (0.0, 1.0),
    ),
    "an infinite constant": ([("div", (0, INF))], (0.0, 1.0)),
    "no number": ([("mul", (0, NAN))], (0.0, 1.0)),
    "no number as a limit": ([("min", (0, NAN))], (0.0, 1.0)),
    "a constant zero as a divisor": ([("div", (0, 0.0))], (1.0, 2.0)),
    "a step of constants": ([("div", (1.0, 0.0)), ("min", (2, 0))], (0.0, 1.0)),
    "a fault beside a sound step": ([("add", (0, 1)), ("div", (2, INF)), ("exp", (2,))], NEAR_ONE),
    "product of two larger numbers": ([("mul", (0, 1))], (-1e155, 1e155), (0.0, 1e155)),
}


@pytest.mark.parametrize("case", DEFINED)
def test_a_domain_is_proven_up_to_its_ends(case):
    steps, *sides = DEFINED[case]
    assert proven(steps, *sides).holds


@pytest.mark.parametrize("case", UNDEFINED)
def test_what_is_just_outside_of_a_domain_is_refused(case):
    steps, *sides = UNDEFINED[case]
    assert proven(steps, *sides).bound == -INF


def test_conditions_may_be_constants():
    assert denominators._is_defined(Step("and", (True, False)))
    assert denominators._is_defined(Step("select", (True, 0, 1.0)))
    assert not denominators._is_defined(Step("select", (True, 0, INF)))


def test_an_infinite_output_is_refused():
    steps = [("add", (0, 1))]
    assert proven(steps, outputs=(2, 0.5)).holds
    for bad in (INF, -INF, NAN):
        assert not proven(steps, outputs=(2, bad)).holds
        assert not proven(steps, outputs=(bad,)).holds


@pytest.mark.parametrize("sign", [1, -1])
def test_a_bound_is_nine_tenths_of_the_least_divisor_at_least(sign):
    # The divisors x² − x + 0.3 and y + 2 are at least 0.05 and 2; either may be the first.
    steps = [("mul", (0, 0)), ("sub", (2, 0)), ("add", (3, 0.3)), ("mul", (4, float(sign)))]
    other = [("add", (1, 2.0)), ("div", (1.0, 6)), ("div", (7, 5))]
    found = proven([*steps, *other], (0.0, 1.0), (0.0, 1.0))
    assert 0.9 * 0.05 <= found.bound <= 0.05


def test_what_is_proven_of_values_is_told_to_the_test_of_overflow(monkeypatch):
    seen = {}

    def spy(program, box, known):
        seen.update(known)
        return []

    monkeypatch.setattr(denominators, "unbounded_values", spy)
    # Divisors 2 and 4, of which the second is negative; radicands 2 and 3
    steps = [("add", (0, 0.5)), ("mul", (0, 1)), ("sub", (0, 3.0)), ("div", (1.0, 2))]
    steps += [("div", (1.0, 4)), ("sqrt", (2,)), ("sqrt", (3,))]
    boxes = proven(steps, (0.5, 1.0), (0.25, 1.0)).boxes
    assert seen.keys() == {2, 3}
    assert 0.9 <= seen[2] <= 1 and 0.1 <= seen[3] <= 0.125
    # Two divisors and two radicands
    assert boxes >= 4
