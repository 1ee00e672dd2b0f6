"""Exact values along lines: polynomials through a few values, with an error that covers them."""

import jax.numpy as jnp
import numpy as np
import pytest

from integrals import Axis, Estimate, R, Reference, Sampling
from integrals import along_lines as module
from integrals.along_lines import TOLERANCE, estimates_along_lines
from integrals.many_points import estimates_at_many
from integrals.reference import Smooth

AXES = (Axis("a", 0.0, 1.0), Axis("b", 0.0, 2.0))
STATED = 1e-12
SMOOTH = Smooth("b")


def reference(function) -> Reference:
    return Reference(
        name="line",
        symbol="L",
        meaning="",
        definition="",
        axes=AXES,
        sampling=Sampling(fitted=3, checked=3, judged=3),
        quadrature=lambda a, b: Estimate(function(a, b), jnp.full((), STATED)),
        batch=64,
        smooth_along=(SMOOTH,),
    )


def grid(lines: int, points: int) -> np.ndarray:
    a, b = np.meshgrid(np.linspace(0, 1, lines), np.linspace(0, 2, points), indexing="ij")
    return np.stack([a.ravel(), b.ravel()], axis=1)


class Counted:
    """The exact values of a function, with the number of points that were evaluated."""

    def __init__(self, function):
        self.function, self.count = function, 0

    def __call__(self, points: np.ndarray) -> Estimate:
        self.count += len(points)
        return Estimate(self.function(*points.T), np.full(len(points), STATED))


def along(function, points: np.ndarray) -> tuple[Estimate, int]:
    exact = Counted(function)
    return estimates_along_lines(reference(function), SMOOTH, points, exact), exact.count


def test_a_smooth_line_takes_few_values_and_states_its_error():
    points = np.random.default_rng(1).permutation(grid(3, 400))
    found, count = along(lambda a, b: np.exp(a * b) / 8, points)
    # The check of 17 nodes, by 9 of them, is not good enough for the steepest line.
    assert count == 3 * 17 + 16
    wrong = np.abs(found.value - np.exp(points[:, 0] * points[:, 1]) / 8)
    assert (wrong <= found.error).all()
    assert (found.error <= 3.2 * STATED + TOLERANCE).all()


def test_a_line_of_a_peak_takes_more_nodes_and_a_kink_every_point():
    def shape(a, b):
        peak = 1 / (1 + 1.5 * (b - 1) ** 2)
        return np.where(a < 0.25, np.sin(b), np.where(a < 0.75, peak, abs(b - 0.7)))

    points = grid(3, 400)
    found, count = along(shape, points)
    # The nodes of the first try are among those of the second.
    assert count == 3 * 17 + 3 * 16 + 2 * 32 + 64 + 400
    wrong = np.abs(found.value - shape(*points.T))
    assert (wrong <= found.error).all()
    assert (found.value[800:] == shape(*points[800:].T)).all()


@pytest.mark.parametrize("count", module._COUNTS)
def test_errors_at_the_nodes_grow_by_the_lebesgue_constant_at_most(count):
    """Errors of the worst signs, which the stated error covers and hardly exceeds."""
    nodes = 2 * module._nodes(count)
    between = np.linspace(0, 2, 20_001)
    worst = np.abs(module._matrix(nodes, between)).sum(axis=1)
    assert worst.max() <= module._LEBESGUE[count] < 1.01 * worst.max()
    if count == 33:
        signs = np.sign(module._matrix(nodes, between[[worst.argmax()]]))[0]
        points = np.stack([np.zeros(400), between[worst.argmax() + np.arange(-200, 200)]], axis=1)
        points[[0, -1], 1] = [0, 2]

        def exact(points):
            off = STATED * np.interp(points[:, 1], nodes, signs)
            return Estimate(np.cos(points[:, 1]) + off, np.full(len(points), STATED))

        found = estimates_along_lines(reference(None), SMOOTH, points, exact)
        wrong = np.abs(found.value - np.cos(points[:, 1])).max()
        assert 3 * STATED < wrong <= found.error.min()


def test_the_stated_error_has_what_the_half_of_the_nodes_miss():
    """A peak of which 17 nodes miss less than what is tolerated."""

    def peak(a, b):
        return 1 / (1 + 0.34 * (b - 1) ** 2) + 0 * a

    points = grid(1, 200)
    found, count = along(peak, points)
    assert count == 33
    nodes = 2 * module._nodes(17)
    by_half = module._matrix(nodes, points[:, 1]) @ peak(0, nodes)
    missed = np.abs(by_half - peak(0, points[:, 1])).max()
    # It is measured at the other nodes only, so that a little may be missed.
    assert 100 * STATED < 0.9 * missed < found.error.min()


def test_few_points_are_evaluated_one_by_one():
    points = grid(2, 33)
    found, count = along(lambda a, b: a + b, points)
    assert count == len(points)
    assert (found.error == STATED).all()


def test_a_line_may_be_smooth_in_the_logarithm():
    """A function that is not smooth at 0, which the points come near to."""
    points = np.stack([np.full(400, 0.5), np.geomspace(1e-6, 2, 400)], axis=1)
    exact = Counted(lambda a, b: np.sqrt(b) * a)
    found = estimates_along_lines(reference(None), Smooth("b", True), points, exact)
    assert exact.count == 33
    assert (np.abs(found.value - 0.5 * np.sqrt(points[:, 1])) <= found.error).all()
    exact = Counted(lambda a, b: np.sqrt(b) * a)
    estimates_along_lines(reference(None), SMOOTH, points, exact)
    assert exact.count == 129 + 400


def test_outside_the_domain_there_is_no_value():
    points = grid(1, 200)
    points[:3, 1] = [-0.1, 2.1, np.nan]
    found, _ = along(lambda a, b: a + b, points)
    assert np.isnan(found.value[:3]).all() and np.isnan(found.error[:3]).all()
    assert not np.isnan(found.value[3:]).any()


@pytest.mark.parametrize("alpha", [0.08, 0.3])
def test_r_on_a_line_is_the_integral_within_the_errors(alpha):
    points = np.stack([np.full(300, alpha), np.linspace(0, np.pi / 2, 300)], axis=1)
    found = estimates_at_many(R, points)
    some = points[7::60]
    alone = R.estimates(some)
    allowed = np.asarray(found.error)[7::60] + np.asarray(alone.error)
    assert (np.abs(np.asarray(found.value)[7::60] - np.asarray(alone.value)) <= allowed).all()
    # By the rule for many points, whose stated error is below 2e-9 here.
    assert (np.asarray(found.error) <= 3.61 * 2e-9 + TOLERANCE).all()
