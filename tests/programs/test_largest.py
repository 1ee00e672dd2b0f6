"""The search for the largest value in compiled interval arithmetic, and its proof."""

import functools
import itertools

import jax.numpy as jnp
import numpy as np
import pytest

from programs.bounding import largest
from programs.bounding.compiled import BUDGET, FINISHED, REFUTED, STUCK, compiler_missing
from programs.bounding.largest import (
    LargestValue,
    Standing,
    Worker,
    bound_largest,
    bound_largest_slowly,
    uphill,
)
from programs.functions import Function, Parameter
from programs.tracing.tracer import trace
from tests.programs.kernels import NAMES, kernel_of

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

UNIT = np.array([[0.0, 1.0]])

KNOWN = {
    # expression, box, its largest absolute value
    "parabola": (lambda x: x * (1 - x), [(0, 1)], 0.25),
    "at an end": (lambda x: 1 / (1 + x) - 0.2, [(0, 1)], 0.8),
    "negative": (
        lambda x: -jnp.exp(-x) * jnp.sin(3 * x),
        [(0, 2)],
        np.exp(-np.arctan(3) / 3) * 3 / 10**0.5,
    ),
    "constant": (lambda x: 0 * x + 0.7, [(0, 1)], 0.7),
    "two sides": (lambda x, y: x * x - y * y + x * y / 2, [(-1, 1), (-1, 2)], 4.25),
    "narrow": (lambda x, y: 1 / (1 + 1e4 * ((x - 0.3) ** 2 + (y - 0.7) ** 2)), [(0, 1), (0, 1)], 1),
    "kink": (lambda x, y: jnp.maximum(x, y) - jnp.abs(x - 0.5), [(0, 1), (0, 1)], 1.0),
    "power": (lambda x: jnp.power(x, 2.5) - jnp.power(x, 0.5), [(0, 1)], 0.8 * 0.2**0.25),
    "three sides": (lambda x, y, z: x * y * z - (x + y + z) / 3, [(0, 1)] * 3, 2 / 3),
}


@functools.cache
def known(name: str):
    return kernel_of(KNOWN[name][0], len(KNOWN[name][1]))


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", KNOWN)
def test_the_largest_value_is_found_and_bounded(name, threads):
    call, box, exact = KNOWN[name]
    found = bound_largest(known(name), np.array(box, float), 1.001, threads=threads)
    assert found.lower <= exact * (1 + 1e-6) and found.upper >= exact * (1 - 1e-6)
    assert found.lower <= found.upper <= 1.0011 * found.lower
    value = abs(float(call(*found.at)))
    assert value == pytest.approx(found.lower, rel=1e-9)


@pytest.mark.parametrize("name", ["parabola", "two sides", "narrow"])
def test_the_search_in_python_agrees(name):
    call, box, exact = KNOWN[name]
    parameters = tuple(Parameter(each, (-1.0, 1.0)) for each in NAMES[: len(box)])
    program = trace(Function("toy", "", parameters, None, "value", call))
    found = bound_largest_slowly(program, np.array(box, float), 1.01)
    assert exact * (1 - 1e-6) <= found.upper <= 1.01 * exact


def test_a_claim_is_proven_or_refuted_with_a_point():
    call, box, exact = KNOWN["narrow"]
    kernel = known("narrow")
    proven = bound_largest(kernel, np.array(box, float), 1.01, claim=1.0001)
    assert exact <= proven.upper <= 1.0001
    refuted = bound_largest(kernel, np.array(box, float), 1.01, claim=0.999)
    assert refuted.upper is None and refuted.lower > 0.999
    assert call(*refuted.at) > 0.999


def test_a_ratio_that_is_not_above_one_is_refused():
    with pytest.raises(ValueError, match="allowed is a finite number above 1"):
        bound_largest(kernel_of(lambda x: x), UNIT, 1.0)


def test_a_search_gives_up_after_too_many_boxes():
    kernel = kernel_of(lambda x, y: jnp.sin(50 * x * y) * x, 2)
    assert bound_largest(kernel, np.array([[0.0, 1.0]] * 2), 1.000001, max_boxes=10).upper is None


def test_a_search_stays_within_its_stack_and_goes_on_with_a_larger_one():
    box = np.array(KNOWN["narrow"][1], float)
    worker = Worker(known("narrow"), box, 1.001, None)
    memory = np.full((64, 2, 2), np.nan)
    worker.stack = memory[:9]
    worker.push(box)
    while worker.state.depth:
        worker.run()
        assert np.isnan(memory[9:]).all() and not worker.failed
    whole = bound_largest(known("narrow"), box, 1.001, threads=1)
    assert len(worker.stack) > 9
    assert worker.state.reached == pytest.approx(whole.upper, rel=1e-3)


def test_the_boxes_of_a_proof_cover_the_whole_box():
    leaves = np.empty((100_000, 2, 1))
    leaves[:] = np.nan
    found = bound_largest(
        kernel_of(lambda x: jnp.sin(9 * x) * x), UNIT, 1.001, threads=1, leaves=leaves
    )
    kept = leaves[~np.isnan(leaves[:, 0, 0]), :, 0]
    assert 10 < len(kept) < found.boxes
    kept = kept[np.argsort(kept[:, 0])]
    assert kept[0, 0] == 0 and kept[-1, 1] == 1
    np.testing.assert_array_equal(kept[1:, 0], kept[:-1, 1])


@pytest.mark.parametrize("name", ["two sides", "narrow"])
def test_the_bound_holds_on_each_box_of_the_proof(name):
    """Eight boxes are examined together; here, each one again by itself."""
    leaves = np.full((100_000, 2, 2), np.nan)
    box = np.array(KNOWN[name][1], float)
    found = bound_largest(known(name), box, 1.01, threads=1, leaves=leaves)
    kept = leaves[~np.isnan(leaves[:, 0, 0])]
    area = np.sum(np.prod(kept[:, 1] - kept[:, 0], axis=1))
    assert area == pytest.approx(np.prod(box[:, 1] - box[:, 0]), rel=1e-9)
    bounds = np.array([known(name).enclose(each.T)[:2] for each in kept])
    assert found.upper == max(found.lower, np.abs(bounds).max())


def test_no_part_of_the_box_is_lost_or_examined_twice_by_threads(monkeypatch):
    monkeypatch.setattr(largest, "_CHUNK", 8)
    standings: list[Standing] = []
    box = np.array(KNOWN["narrow"][1], float)
    found = bound_largest(known("narrow"), box, 1.00001, threads=3, progress=standings.append)
    assert len(standings) > 5
    assert standings[-1].part == pytest.approx(1, abs=1e-9)
    assert standings[-1].boxes == found.boxes
    for before, after in itertools.pairwise(standings):
        assert before.part <= after.part and before.seconds <= after.seconds
        assert 0 < after.boxes - before.boxes <= 3 * 16
        assert before.lower <= after.lower <= found.lower


def test_the_remaining_time_is_that_of_the_part_that_remains():
    assert Standing(0.0, 1, 2.0, 0.0).remaining == np.inf
    assert Standing(0.25, 1, 2.0, 0.0).remaining == 6
    assert Standing(1.0 + 1e-9, 1, 2.0, 0.0).remaining == 0


def test_the_search_begins_with_the_largest_value_at_the_seeds():
    """A seed outside of the box counts at its side, and one without a value does not count."""
    kernel = kernel_of(lambda x, y: 1 / x - y, 2)
    box = np.array([[-1.0, 2.0], [0.0, 4.0]])
    best = functools.partial(largest._best_seed, kernel, box)
    low, at = best(None)
    assert low == pytest.approx(0) and at == (0.5, 2.0)
    low, at = best(np.array([[0.25, 1.0], [-0.5, 9.0], [0.0, 1.0], [0.5, 0.5]]))
    assert low == pytest.approx(6) and at == (-0.5, 4.0)
    # Without a value at the middle
    box[0, 1] = 1.0
    assert largest._best_seed(kernel, box, None) == (0.0, (0.0, 2.0))


@pytest.mark.parametrize(
    ("inexact", "expected"), [(0.0, 1.04), (0.004, 1.04 - 2.05 * 0.008), (9.0, 1.02)]
)
def test_room_is_left_for_what_the_caller_adds_to_the_bounds(monkeypatch, inexact, expected):
    """The level is above the largest value by less, but half of the room is left to the search."""
    ratios = []

    class Recorded(Worker):
        def __init__(self, kernel, box, ratio, claim):
            ratios.append(ratio)
            super().__init__(kernel, box, ratio, claim)

    monkeypatch.setattr(largest, "Worker", Recorded)
    kernel, box = kernel_of(lambda x: x - 0.5), np.array([[0.0, 1.0]])
    found = bound_largest(kernel, box, 1.04, inexact=inexact, seeds=np.array([[1.0]]), threads=1)
    assert ratios == [pytest.approx(expected, rel=1e-12)]
    if inexact < 1:
        assert found.upper + inexact <= 1.04 * (found.lower - inexact)
    # A search that begins with the value 0 knows no ratio.
    bound_largest(kernel, box, 1.04, inexact=inexact, threads=1)
    assert ratios[1] == 1.04


def test_uphill_stays_in_the_box_and_comes_to_its_largest_value():
    kernel = kernel_of(lambda x, y: x * (2 - x) - y, 2)
    box = np.array([[0.0, 0.75], [-0.5, 1.0]])
    lower, at = uphill(kernel, box, 0.5, (0.7, -0.4))
    assert at[0] <= 0.75 and at[1] >= -0.5
    assert 0.9375 + 0.5 - 1e-4 < lower <= 0.9375 + 0.5
    # A point that is higher elsewhere is kept.
    assert uphill(kernel, box, 9.0, (0.5, 0.25)) == (9.0, (0.5, 0.25))


def test_pieces_cover_the_box():
    box = np.array([[0.1, 0.7], [2.0, 3.0]])
    pieces = largest._pieces(box, 7)
    assert [each[1].tolist() for each in pieces] == [[2.0, 3.0]] * 7
    ends = [each[0].tolist() for each in pieces]
    assert ends[0][0] == 0.1 and ends[-1][1] == 0.7
    assert [high for _, high in ends[:-1]] == [low for low, _ in ends[1:]]
    np.testing.assert_allclose(np.diff(ends), 0.6 / 7)


def test_a_value_above_the_bound_is_a_fault(monkeypatch):
    monkeypatch.setattr(largest, "uphill", lambda *_: (2.0, (0.5,)))
    with pytest.raises(RuntimeError, match="is above the proven bound"):
        bound_largest(known("parabola"), UNIT, 1.1)


def test_a_claim_that_is_refuted_at_a_seed_has_no_bound():
    box, seeds = np.array(KNOWN["narrow"][1], float), np.array([[0.3, 0.7]])
    found = bound_largest(known("narrow"), box, 1.01, claim=0.999, seeds=seeds, threads=1)
    assert found.upper is None and found.lower == pytest.approx(1) and found.boxes == 0
    # A claim that is the largest value itself is proven where bounds are exact.
    constant = kernel_of(lambda x: 0 * x + 0.75)
    assert bound_largest(constant, UNIT, 1.01, claim=0.75).upper == 0.75
    below = np.nextafter(0.75, 0)
    assert bound_largest(constant, UNIT, 1.01, claim=below).upper is None


def worker_of(name: str, claim: float | None = None, budget: int = 1000) -> Worker:
    box = np.array(KNOWN[name][1], float)
    worker = Worker(known(name), box, 1.001, claim)
    worker.state.budget = budget
    worker.push(box)
    return worker


def test_a_run_ends_with_its_status():
    worker = worker_of("narrow", budget=20)
    worker.run()
    assert worker.state.status == BUDGET and 20 <= worker.state.boxes < 28
    worker.run()
    assert worker.state.status == BUDGET and 40 <= worker.state.boxes < 56
    worker = worker_of("narrow", claim=0.5)
    worker.run()
    assert worker.state.status == REFUTED and worker.state.lower > 0.5 and not worker.failed
    worker = worker_of("parabola")
    worker.run()
    assert worker.state.status == FINISHED and worker.state.depth == 0
    assert worker.state.volume == pytest.approx(1, abs=1e-12)
    kernel = kernel_of(lambda x: 1 / x)
    worker = Worker(kernel, UNIT, 1.001, None)
    worker.push(UNIT)
    worker.run()
    assert worker.state.status == STUCK and worker.failed
    assert worker.last()[0] < 1e-300


def test_boxes_remain_when_one_cannot_be_divided():
    """Seven intervals and a point at a pole: none is lost, and the last one is in the message."""
    worker = Worker(kernel_of(lambda x: 1 / x), np.array([[0.0, 8.0]]), 1.5, None)
    worker.state.level = 0.01
    ends = [[float(k), k + 1.0] for k in range(1, 5)] + [[0.0, 0.0]] + [[5.0, 6.0], [6.0, 7.0]]
    for each in ends:
        worker.push(np.array([each]))
    worker.run()
    assert worker.state.status == STUCK
    kept = worker.stack[: worker.state.depth, :, 0].tolist()
    for low, high in ends[4:]:
        assert [low, high] in kept
    total = sum(high - low for low, high in kept)
    assert total + 8 * worker.state.volume == pytest.approx(6)


def test_the_centre_has_its_own_bounds():
    kernel = kernel_of(lambda x: jnp.where(x < 0.5, x, 3 - x))
    for low, high in ((0.4, 0.58), (0.45, 0.57), (0.6, 0.8)):
        middle = (low + high) / 2
        value = middle if middle < 0.5 else 3 - middle
        below, above, *centre = kernel.enclose(np.array([[low, high]]))
        assert below <= centre[0] <= value <= centre[1] <= above


def test_the_slow_search_finds_the_largest_value_and_where_it_is():
    call, box, exact = KNOWN["two sides"]
    parameters = tuple(Parameter(each, (-1.0, 1.0)) for each in NAMES[:2])
    program = trace(Function("toy", "", parameters, None, "value", call))
    seeds = np.array([[0.0, 9.0], [-2.0, 2.0], [0.5, 0.5]])
    found = bound_largest_slowly(program, np.array(box, float), 1.01, seeds=seeds)
    assert found.at == (0.0, 2.0) and found.lower == pytest.approx(4) and found.boxes > 1
    assert exact <= found.upper <= 1.01 * exact
    found = bound_largest_slowly(program, np.array(box, float), 1.01)
    assert found.at == (0.0, 0.5) and found.lower == pytest.approx(0.25)
    with pytest.raises(ValueError, match="allowed is a finite number above 1"):
        bound_largest_slowly(program, np.array(box, float), 1.0)
    pole = trace(Function("pole", "", parameters[:1], None, "value", lambda x: 1 / x))
    found = bound_largest_slowly(pole, np.array([[-1.0, 1.0]]), 1.01)
    assert found == LargestValue(0.0, (0.0,), None, found.boxes)
