"""The adaptive rule by parts: where its boxes are, what a step does, which errors it states."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.polynomial import Legendre

from integrals.rules import adaptive as rule
from integrals.rules.boxes import LEAST_SIDE, Box, Boxes, first_places, measured
from integrals.rules.effort import Effort

EPSILON = np.finfo(float).eps


def test_the_first_boxes_are_equal_parts_of_the_segments():
    """Four parts of one segment, and two of each of three."""
    parts = [
        [(0, k / 4, (k + 1) / 4) for k in range(4)],
        [(s, k / 2, (k + 1) / 2) for s in range(3) for k in range(2)],
    ]
    expected = np.array(list(itertools.product(*parts)))
    for found, each in zip(first_places([1, 3], 4), np.moveaxis(expected, -1, 0), strict=True):
        np.testing.assert_array_equal(found, each)


def test_a_box_is_a_part_of_its_segments():
    edges = [jnp.array([0.0, 0.25, 1.0]), jnp.array([0.0, 1.0])]
    box = Box(edges, jnp.array([1, 0]), jnp.array([0.5, 0.25]), jnp.array([1.0, 0.75]))
    np.testing.assert_array_equal(box.origin, [0.625, 0.25])
    np.testing.assert_array_equal(box.sides, [0.375, 0.5])
    assert box.volume == 0.1875 and box.side == 0.375
    # The smallest part of the coordinate of its upper end may be that of a longer side.
    box = Box(edges, jnp.array([0, 0]), jnp.array([0.0, 0.5]), jnp.array([1.0, 1.0]))
    assert box.volume == 0.125 and box.side == 0.5


def test_an_empty_box_is_zero_also_where_the_integrand_has_no_value():
    edges = [jnp.array([0.0, 1.0, 1.0]), jnp.array([0.0, 1.0])]
    for lower, upper in ((0.0, 1.0), (0.5, 0.5)):
        box = Box(edges, jnp.array([1, 0]), jnp.array([0.0, lower]), jnp.array([1.0, upper]))
        assert box.volume == 0 and box.side == 0
        found = box.values(lambda x: 1 / (1 - x[0]), np.array([[0.25, 0.25], [0.5, 0.5]]))
        np.testing.assert_array_equal(found, [0.0, 0.0])


# What the rule states of one box

NODES = 8


def missed_on_line(integrand, begin: float, side: float) -> float:
    """Return what eight nodes miss on a line, over its length, by NumPy's Legendre series."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    points = begin + side * (nodes + 1) / 2
    series = Legendre.fit(points, integrand(points), NODES - 1, domain=[begin, begin + side])
    missed = np.abs(series.coef[-2:]).max()
    for end, inside in ((begin, side * LEAST_SIDE), (begin + side, -side * LEAST_SIDE)):
        gaps = np.abs(integrand(np.array([end, end + inside])) - series(end))
        missed += weights[0] / 2 * (gaps.min() if np.isfinite(gaps).all() else 0.0)
    return float(missed)


def jump_before(x):
    return (x > 0.75 - 1e-7) * 1.0


LINES = {
    "kink": lambda x: abs(x - 0.6),
    "power": lambda x: x**7,
    "jump before the last node": jump_before,
    "jump after the first node": lambda x: (x > 0.5 + 1e-7) * 1.0,
    "jump at the lower end": lambda x: (x > 0.5) * 1.0,
    "jump at the upper end": lambda x: (x >= 0.75) * 1.0,
    "singularity at the lower end": lambda x: abs(x - 0.5) ** -0.5,
    "singularity at the upper end": lambda x: abs(x - 0.75) ** -0.5,
    "oscillation": lambda x: 3 + 7 * jnp.sin(60 * x),
}


@pytest.mark.parametrize("name", LINES)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_the_error_of_a_box_is_the_sum_of_its_three_parts(name):
    """On [½, ¾], the second of three segments."""
    call = LINES[name]
    effort = Effort(NODES, 1, 0, 1, 0.0)
    edges = [jnp.array([0.0, 0.4, 0.8, 1.0])]
    places = np.array([[1]]), np.array([[0.25]]), np.array([[0.875]])
    found = measured(lambda x: call(x[0]), (), edges, effort, *places)

    def gauss(nodes: int, integrand) -> float:
        x, w = np.polynomial.legendre.leggauss(nodes)
        return float(np.sum(w * integrand(0.625 + 0.125 * x)) / 8)

    value = gauss(NODES, call)
    np.testing.assert_allclose(found.value, value, rtol=1e-14)
    np.testing.assert_allclose(found.size, gauss(NODES, lambda x: abs(call(x))), rtol=1e-14)
    assert found.slowness == 1
    expected = missed_on_line(call, 0.5, 0.25) / 4 + abs(value - gauss(6, call))
    np.testing.assert_allclose(found.errors, [[expected]], rtol=1e-8, atol=1e-15)


def test_each_variable_has_an_error_of_its_own():
    """The error by one variable is the mean of what its lines miss, at the nodes of the other."""

    def call(x, y):
        return abs(x - 0.6) * (1 + y * y) + 1e-3 * abs(y - 0.3) ** 3

    effort = Effort(NODES, 1, 0, 1, 0.0)
    places = np.array([[0, 0]]), np.array([[0.5, 0.0]]), np.array([[0.75, 1.0]])
    edges = [jnp.array([0.0, 1.0])] * 2
    found = measured(lambda x: call(*x), (), edges, effort, *places)

    def gauss(nodes: int):
        x, w = np.polynomial.legendre.leggauss(nodes)
        return 0.625 + 0.125 * x, 0.5 + 0.5 * x, w / 2

    def value(nodes: int) -> float:
        x, y, w = gauss(nodes)
        return float(w @ call(x[:, None], y) @ w) / 4

    x, y, w = gauss(NODES)
    along_x = [missed_on_line(lambda t, at=at: call(t, at), 0.5, 0.25) for at in y]
    along_y = [missed_on_line(lambda t, at=at: call(at, t), 0.0, 1.0) for at in x]
    both = abs(value(NODES) - value(6)) / 2
    expected = [w @ along_x / 4 + both, w @ along_y / 4 + both]
    assert expected[0] > 2 * expected[1] > 2 * both
    np.testing.assert_allclose(found.errors, [expected], rtol=1e-8)
    np.testing.assert_allclose(found.value, value(NODES), rtol=1e-14)


# Steps


def boxes_of(errors, values=None, side=None, slowness=None, size=None) -> Boxes:
    """Return boxes in one variable; where they are does not count."""
    errors = jnp.array(errors, float)
    ones, places = jnp.ones(len(errors)), jnp.zeros((len(errors), 1))
    numbers = [ones if each is None else jnp.array(each, float) for each in (side, slowness, size)]
    value = ones if values is None else jnp.array(values, float)
    return Boxes(places, places, places, value, errors[:, None], numbers[2], *numbers[:2])


def test_a_box_of_the_least_side_is_not_halved_and_nan_is_the_worst():
    boxes = boxes_of([1, np.nan, 5, 2, 3], side=[1, 1, LEAST_SIDE, 2 * LEAST_SIDE, 1])
    boxes = boxes._replace(slowness=jnp.array([1.0, 1, 1, 1, 4]))
    np.testing.assert_array_equal(rule._priority(boxes), [1, np.inf, 0, 2, 12])


def test_steps_end_when_the_error_is_small_or_no_more_are_allowed_or_possible():
    effort = Effort(NODES, 1, steps=3, splits=1, tolerance=0.25)
    large = boxes_of([0.5, 0.75], slowness=[1, 2], size=[5, 2])
    for step, boxes, expected in (
        (0, large, True),
        (2, large, True),
        (3, large, False),
        # The error is 2.
        (0, boxes_of([0.5, 0.75], slowness=[1, 2], size=[5, 3]), False),
        (0, large._replace(side=jnp.array([1, LEAST_SIDE])), True),
        (0, large._replace(side=jnp.full(2, LEAST_SIDE)), False),
        (0, boxes_of([0.0, 0.0], size=[0, 0]), False),
        (0, boxes_of([np.nan, 0.0]), True),
    ):
        assert rule._unfinished(effort, step, boxes) == expected


@pytest.mark.parametrize(
    ("error", "value", "halves", "values", "kept", "slowness"),
    [
        pytest.param(4, 2, [1, 1], [1, 1], False, 2, id="half the error"),
        pytest.param(4, 2, [3, 0.5], [1, 1], False, 8, id="slow"),
        pytest.param(4, 2, [9, 0.5], [1, 1], False, 200, id="not smaller"),
        pytest.param(0, 2, [1, 1], [1, 1], False, 1, id="no error before"),
        pytest.param(4, 2, [1, 1], [np.nan, 1], True, 0, id="no value"),
        pytest.param(4, 2, [1, 1], [1, np.inf], True, 0, id="an infinite value"),
        pytest.param(4, 2, [1, np.inf], [1, 1], True, 0, id="no error"),
        pytest.param(np.nan, 2, [1, 1], [1, 1], False, 1, id="no error of the box"),
        pytest.param(4, np.inf, [1, 1], [1, 1], False, 1, id="no value of the box"),
        pytest.param(4, np.nan, [np.nan, 1], [1, 1], False, 1, id="neither"),
    ],
)
def test_halves_take_the_place_of_a_box_if_they_are_finite(
    error, value, halves, values, kept, slowness
):
    """Beside a box whose error becomes a quarter of what it was."""
    whole = boxes_of([8, error], [7, value], side=[1, 0.5], slowness=[3, 5])
    after = boxes_of(
        [1.5, halves[0], 0.5, halves[1]], [6, values[0], 1, values[1]], side=[0.5, 0.25] * 2
    )
    found = rule._accepted(whole, after)
    np.testing.assert_array_equal(found.errors[[0, 2], 0], [1.5, 0.5])
    np.testing.assert_allclose(found.slowness[jnp.array([0, 2])], 4 / 3, rtol=1e-15)
    here = jax.tree.map(lambda x: x[jnp.array([1, 3])], found)
    if kept:
        # The whole box, which is not halved again, and an empty one
        np.testing.assert_array_equal(here.value, [value, 0])
        np.testing.assert_array_equal(here.errors, [[error], [0]])
        np.testing.assert_array_equal(here.side, [0, 0])
        np.testing.assert_array_equal(here.slowness, [5, 0])
    else:
        np.testing.assert_array_equal(here.value, values)
        np.testing.assert_array_equal(here.errors[:, 0], halves)
        np.testing.assert_array_equal(here.side, [0.25, 0.25])
        np.testing.assert_allclose(here.slowness, [slowness] * 2, rtol=1e-13)


def test_a_step_halves_the_worst_boxes_across_the_variable_of_the_largest_error():
    effort = Effort(nodes=4, panels=2, steps=2, splits=2, tolerance=0.0)
    edges = [jnp.array([0.0, 1.0])] * 2

    def integrand(x):
        return x[0] ** 3 + x[1]

    # The boxes are [0, ½]², [0, ½]×[½, 1], [½, 1]×[0, ½] and [½, 1]², and four that are not used.
    boxes = jax.jit(lambda: rule._first(integrand, lambda: edges, effort))()
    np.testing.assert_array_equal(boxes.upper, [*np.array(boxes.lower[:4]) + 0.5, *[[0, 0]] * 4])
    np.testing.assert_array_equal(boxes.value[4:], np.zeros(4))
    errors = np.zeros((8, 2))
    errors[:4] = [[1, 0], [2, 9], [3, 4], [8, 0]]
    step = jax.jit(
        lambda k, boxes: rule._with_worst_halved(integrand, lambda: edges, effort, k, boxes)
    )
    boxes = step(0, boxes._replace(errors=jnp.array(errors)))
    np.testing.assert_array_equal(boxes.lower[:4], [[0, 0], [0, 0.5], [0.5, 0], [0.5, 0.5]])
    np.testing.assert_array_equal(boxes.upper[:4], [[0.5, 0.5], [0.5, 0.75], [1, 0.5], [0.75, 1]])
    np.testing.assert_array_equal(boxes.lower[4:6], [[0, 0.75], [0.75, 0.5]])
    np.testing.assert_array_equal(boxes.upper[4:6], [[0.5, 1], [1, 1]])
    np.testing.assert_array_equal(boxes.value[6:], [0, 0])
    # The errors of the halves are those of rounding: the other two boxes are the worst now.
    boxes = step(1, boxes)
    np.testing.assert_array_equal(boxes.upper[:4], [[0.25, 0.5], [0.5, 0.75], [1, 0.25], [0.75, 1]])
    (x, y), (right, top) = np.transpose(boxes.lower), np.transpose(boxes.upper)
    exact = (right**4 - x**4) / 4 * (top - y) + (right - x) * (top**2 - y**2) / 2
    np.testing.assert_allclose(boxes.value, exact, rtol=1e-14)
    np.testing.assert_allclose(np.sum(boxes.value), 0.75, rtol=1e-14)


def test_the_stated_error_has_the_rounding_of_the_sum():
    effort = Effort(nodes=4, panels=1, steps=0, splits=1, tolerance=0.0)
    edges = [jnp.array([0.0, 1.0])]
    found = jax.jit(
        lambda a: rule.adaptive(lambda x, a: 0 * x[0] + a, lambda a: edges, (a,), effort)
    )(1000.0)
    assert found.value == pytest.approx(1000, rel=1e-15)
    assert 16 * EPSILON * 1000 <= found.error <= 32 * EPSILON * 1000


def test_the_derivative_moves_the_breaks():
    """The integral of 2 up to a and of t·a beyond is 2 a + a (1 − a²)/2."""
    effort = Effort(nodes=4, panels=1, steps=1, splits=1, tolerance=0.0)

    def integral(a):
        return rule.adaptive(
            lambda x, a: jnp.where(x[0] < a, 2.0, x[0] * a),
            lambda a: [jnp.stack([jnp.zeros(()), a, jnp.ones(())])],
            (a,),
            effort,
        ).value

    value, slope = jax.jit(lambda a: jax.jvp(integral, (a,), (2.0,)))(0.3)
    assert value == pytest.approx(0.6 + 0.3 * 0.91 / 2, rel=1e-14)
    assert slope == pytest.approx(2 * (2 + 0.5 - 1.5 * 0.09), rel=1e-13)
