"""The search for points where an error is above a level."""

import functools

import numpy as np
import pytest

from programs.bounding import counterexamples
from programs.bounding.compiled import ROUNDING, Kernel, compiler_missing
from programs.bounding.counterexamples import points_above
from tests.programs.kernels import kernel_of

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

BOX = np.array([[-1.0, 2.0], [0.0, 1.0]])


@functools.cache
def saddle() -> Kernel:
    """Return a kernel of (x − 1)(y + 1)."""
    return kernel_of(lambda x, y: (x - 1) * (y + 1), 2)


def value(points: np.ndarray) -> np.ndarray:
    return (points[:, 0] - 1) * (points[:, 1] + 1)


def test_points_are_in_the_box_and_above_the_level():
    points = points_above(saddle(), BOX, 2.0, max_boxes=100_000)
    assert np.all((points >= BOX[:, 0]) & (points <= BOX[:, 1]))
    assert np.all(np.abs(value(points)) > 2)
    # There is one for each of the 16² cells that has points above, but for those it only touches.
    corners = np.stack(np.meshgrid(*(np.linspace(*side, 17) for side in BOX), indexing="ij"))
    size = np.abs(value(corners.reshape(2, -1).T)).reshape(17, 17)
    largest = np.maximum.reduce([size[:-1, :-1], size[1:, :-1], size[:-1, 1:], size[1:, 1:]])
    assert len(points) == np.sum(largest > 2)


def test_there_are_none_above_the_largest_error():
    assert points_above(saddle(), BOX, 4.0, max_boxes=100_000).shape == (0, 2)
    assert len(points_above(saddle(), BOX, 3.999, max_boxes=100_000)) == 1


def test_the_result_does_not_depend_on_threads():
    one, two = (points_above(saddle(), BOX, 2.0, max_boxes=10**6, threads=n) for n in (1, 2))
    np.testing.assert_array_equal(one, two)


def test_the_search_gives_up():
    """A cell needs a thousand boxes in the first pass: for fewer, none is examined."""
    assert len(points_above(saddle(), BOX, 2.0, max_boxes=999)) == 0
    few = points_above(saddle(), BOX, 2.0, max_boxes=20_000)
    assert 0 < len(few) < len(points_above(saddle(), BOX, 2.0, max_boxes=10**6))


def test_where_the_error_is_not_bounded_no_point_is_returned():
    kernel = kernel_of(lambda x: 1 / x)
    points = points_above(kernel, np.array([[-1.0, 1.0]]), 10.0, max_boxes=10**6)
    assert len(points) > 0
    assert np.all(np.isfinite(points)) and np.all(np.abs(points) < 0.1)


def test_another_rounding_mode_is_refused(monkeypatch):
    def run(worker):
        worker.state.status = ROUNDING

    monkeypatch.setattr(counterexamples.Worker, "run", run)
    with pytest.raises(RuntimeError, match="does not round upward"):
        points_above(saddle(), BOX, 2.0, max_boxes=10**6)
