"""Branch and bound: bounds of functions of two inputs whose extreme values are known."""

import jax.numpy as jnp
import numpy as np
import pytest

from programs.bounding.branch_and_bound import Bounds, BranchAndBound
from programs.functions import Function, Parameter
from programs.program import Program, Step
from programs.tracing.tracer import trace

ANYTHING = (-np.inf, np.inf)
SQUARE = np.array([[-1.0, 1.0], [-1.0, 1.0]])


def program_of(call, names: str = "xy") -> Program:
    parameters = tuple(Parameter(name, (-1.0, 1.0)) for name in names)
    return trace(Function("Example", "An example.", parameters, None, "value", call))


def to_within(room: float):
    """Return the rule that bounds must be within `room` of the values that are attained."""
    return lambda below, above, least, most: (below >= least - room) & (above <= most + room)


# call, least and largest value on the square
KNOWN = {
    "sum": (lambda x, y: x + y, -2.0, 2.0),
    "bowl between the nodes": (lambda x, y: (x - 0.3) ** 2 + (y + 0.2) ** 2, 0.0, 1.69 + 1.44),
    "saddle": (lambda x, y: x * y, -1.0, 1.0),
    "hill": (lambda x, y: 0.6 * x - x * x, -1.6, 0.09),
    "constant": (lambda x, y: jnp.maximum(x, 2.0), 2.0, 2.0),
    "one input": (lambda x, y: jnp.cos(3 * x), np.cos(3), 1.0),
}


@pytest.mark.parametrize("room", [0.1, 1e-3])
@pytest.mark.parametrize("name", KNOWN)
def test_bounds_enclose_the_extreme_values_tightly(name, room):
    call, least, most = KNOWN[name]
    found = BranchAndBound().bound_output(program_of(call), SQUARE, ANYTHING, to_within(room))
    assert least - room <= found.lower <= least
    assert most <= found.upper <= most + room


def test_values_may_reach_the_ends_of_what_is_allowed():
    program = program_of(lambda x, y: x * y)
    found = BranchAndBound().bound_output(program, SQUARE, (-1.0, 1.0), to_within(0.1))
    assert -1.1 <= found.lower <= -1 and 1 <= found.upper <= 1.1


def test_the_side_that_changes_the_output_most_is_divided():
    program = program_of(KNOWN["bowl between the nodes"][0])
    for box in ([[-1.0, 1.0], [-1e-3, 1e-3]], [[-1e-3, 1e-3], [-1.0, 1.0]]):
        found = BranchAndBound().bound_output(program, np.array(box), ANYTHING, to_within(0.01))
        assert 1 < found.boxes < 100 and np.isfinite(found.lower)


def test_tighter_bounds_need_more_boxes():
    program = program_of(KNOWN["bowl between the nodes"][0])
    loose, tight = (
        BranchAndBound().bound_output(program, SQUARE, ANYTHING, to_within(room)).boxes
        for room in (0.1, 1e-3)
    )
    assert loose < tight


@pytest.mark.parametrize("allowed", [(0.0, np.inf), (-np.inf, 0.0), (-0.999, 0.999)])
def test_a_value_that_is_not_allowed_ends_the_search_without_a_proof(allowed):
    program = program_of(lambda x, y: x * y)
    found = BranchAndBound().bound_output(program, SQUARE, allowed, to_within(0.1))
    assert found == Bounds(-np.inf, np.inf, 1)


def test_a_value_that_is_nan_ends_the_search_without_a_proof():
    program = program_of(lambda x, y: jnp.sqrt(x))
    found = BranchAndBound().bound_output(program, SQUARE, ANYTHING, to_within(0.1))
    assert found == Bounds(-np.inf, np.inf, 1)


def test_a_value_that_is_nan_is_not_forgotten_in_later_rounds():
    # It is NaN about x = −0.5, which is a middle of the boxes of the second round.
    program = program_of(lambda x, y: jnp.sqrt((x + 0.5) ** 2 - 1e-3))
    found = BranchAndBound().bound_output(program, SQUARE, ANYTHING, to_within(0.1))
    assert found == Bounds(-np.inf, np.inf, 3)


def test_probes_find_a_value_that_corners_and_middles_miss():
    # The function is negative only within 1e-4 of (0.3, −0.2).
    program = program_of(lambda x, y: (x - 0.3) ** 2 + (y + 0.2) ** 2 - 1e-8)
    probes = np.array([[0.5, 0.5], [0.3, -0.2]])

    def boxes(probes):
        found = BranchAndBound().bound_output(
            program, SQUARE, (0.0, np.inf), to_within(1e-12), probes
        )
        assert found.lower == -np.inf
        return found.boxes

    assert boxes(probes) == 1 < boxes(probes[:1]) and boxes(None) == boxes(probes[:1])


def test_the_limit_on_boxes_ends_the_search_without_a_proof():
    program = program_of(KNOWN["bowl between the nodes"][0])
    found = BranchAndBound(max_boxes=10).bound_output(program, SQUARE, ANYTHING, to_within(1e-3))
    assert (found.lower, found.upper) == (-np.inf, np.inf)
    # The boxes of one round are examined together.
    assert 10 < found.boxes <= 40


def test_the_limit_on_the_size_of_boxes_ends_the_search_without_a_proof():
    # No box around the root x = 0.3 has a positive lower bound, however small it is.
    program = program_of(lambda x, y: (x - 0.3) * (x - 0.3))

    def positive(below, above, least, most):
        return below > 0

    coarse, fine = (
        BranchAndBound(smallest_box=size).bound_output(program, SQUARE, ANYTHING, positive)
        for size in (1e-2, 1e-6)
    )
    assert coarse.lower == fine.lower == -np.inf
    assert coarse.boxes < fine.boxes < 400_000


def test_the_first_split_divides_the_first_sides():
    program = program_of(lambda x, y: x * y)
    solver = BranchAndBound(first_split=(8,))
    assert solver.bound_output(program, SQUARE, ANYTHING, to_within(10.0)).boxes == 8
    both = BranchAndBound(first_split=(8, 4))
    assert both.bound_output(program, SQUARE, ANYTHING, to_within(10.0)).boxes == 32
    assert BranchAndBound().bound_output(program, SQUARE, ANYTHING, to_within(10.0)).boxes == 1


def test_a_first_split_of_more_sides_than_the_box_has_is_refused():
    solver = BranchAndBound(first_split=(4, 4, 4))
    with pytest.raises(ValueError, match=r"first_split is \(4, 4, 4\); allowed: at most 2 counts"):
        solver.bound_output(program_of(lambda x, y: x), SQUARE, ANYTHING, to_within(0.1))


@pytest.mark.parametrize("chunk", [1, 7])
def test_the_number_of_boxes_enclosed_at_a_time_changes_nothing(chunk):
    program = program_of(KNOWN["bowl between the nodes"][0])
    expected = BranchAndBound().bound_output(program, SQUARE, ANYTHING, to_within(0.01))
    found = BranchAndBound(chunk=chunk).bound_output(program, SQUARE, ANYTHING, to_within(0.01))
    assert found == expected


def test_an_input_that_the_output_does_not_depend_on_is_not_divided():
    call = lambda *x: jnp.cos(3 * x[0])  # noqa: E731 - of two or of three inputs
    two = BranchAndBound().bound_output(program_of(call), SQUARE, ANYTHING, to_within(1e-3))
    box = np.concatenate([SQUARE, [[-1e6, 1e6]]])
    three = BranchAndBound().bound_output(program_of(call, "xyz"), box, ANYTHING, to_within(1e-3))
    assert three == two


def test_an_operation_without_an_interval_version_is_refused():
    program = Program("Example", ("x", "y"), (Step("gamma", (0,)),), (2,))
    with pytest.raises(ValueError, match="'gamma'"):
        BranchAndBound().bound_output(program, SQUARE, ANYTHING, to_within(1))
