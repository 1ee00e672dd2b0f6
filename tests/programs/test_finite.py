"""The quick test for overflow: which values of a program have no finite natural bounds on a box."""

import numpy as np
import pytest

from programs.bounding.finite import unbounded_values
from programs.program import Program, Step

# x in [0, 1], y in [−2, 3]; the first step is value number 2.
BOX = np.array([[0.0, 1.0], [-2.0, 3.0]])


def listed(*steps: tuple, proven=None) -> list[int]:
    program = Program("Example", ("x", "y"), tuple(Step(*step) for step in steps), ())
    return unbounded_values(program, BOX, proven or {})


CASES = {
    "bounded": ([("add", (0, 1)), ("mul", (2, 3.0)), ("exp", (3,))], []),
    "above": ([("mul", (0, 800.0)), ("exp", (2 + 0,)), ("exp", (3,))], [3, 4]),
    "below": ([("log", (0,)), ("add", (1, 1.0))], [2]),
    "on both sides": ([("div", (1.0, 1)), ("div", (1.0, 0))], [2, 3]),
    "only its lower bound is finite": ([("mul", (0, 1e200)), ("mul", (2, 2))], [3]),
    # What depends on a value in the list is bounded if that is not larger than float64 allows.
    "half of an overflow": ([("log", (0,)), ("mul", (2, 0.5)), ("neg", (3,))], [2]),
    "twice an overflow": ([("log", (0,)), ("mul", (2, 2.0)), ("max", (3, 0.0))], [2, 3]),
    "cut": ([("log", (0,)), ("max", (2, -5.0)), ("exp", (3,)), ("mul", (4, 1e300))], [2]),
    "cut above": ([("div", (1.0, 0)), ("min", (2, 7.0)), ("max", (3, 0.0)), ("exp", (4,))], [2]),
    "conditions": ([("lt", (0, 1)), ("not", (2,)), ("select", (3, 0, 1)), ("log", (4,))], [5]),
}


@pytest.mark.parametrize("case", CASES)
def test_values_without_finite_bounds_are_listed(case):
    steps, expected = CASES[case]
    assert listed(*steps) == expected


def test_what_is_proven_of_a_value_bounds_those_that_depend_on_it():
    # The natural bounds of y·y + x are above 0.1 only if that is proven.
    steps = [("mul", (1, 0)), ("add", (2, 0)), ("div", (1.0, 3)), ("log", (3,))]
    assert listed(*steps) == [4, 5]
    assert listed(*steps, proven={3: 0.1}) == []
    assert listed(*steps, proven={2: 0.1}) == []
    assert listed(*steps, proven={4: 0.1}) == [4, 5]
    # A bound that is less than what is known anyway changes nothing.
    assert listed(("add", (0, 1.0)), ("div", (1.0, 2)), proven={2: -1.0}) == []
