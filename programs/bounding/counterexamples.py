"""A search for points where an error is above a level, by the branch and bound of proofs.

Points that are tried at random miss a narrow ridge. Bounds on boxes show where the error may be
above the level, so that the search looks there only.
"""

import itertools
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from programs.bounding.compiled import ROUNDING, Kernel
from programs.bounding.largest import Worker, uphill

# The box is divided into about this many cells. At most one point is found in each.
_CELLS = 256
# So many points, those with the largest errors, are moved to larger errors.
_IMPROVED = 16
# In each pass, every cell that is not done examines so many boxes.
_PASSES = (1_000, 10_000, 100_000, 1_000_000)


def points_above(
    kernel: Kernel, box: np.ndarray, level: float, *, max_boxes: int, threads: int = 2
) -> np.ndarray:
    """Return points (m, sides) of a box (sides, 2) whose |error| is proven to be above a level.

    The box is divided into cells, and at most one point of each is returned: the first that is
    found there, or a worse one near it. The worst come first. If there is none, either no error is
    above the level, or the search gave up after `max_boxes` boxes or where the error is not
    bounded. The result does not depend on `threads`. Raises RuntimeError if the processor does not
    round upward.
    """
    workers = []
    for cell in _cells(box):
        worker = Worker(kernel, box, 0.0, level)
        worker.push(cell)
        workers.append(worker)
    with ThreadPoolExecutor(threads) as pool:
        for budget in _PASSES:
            open_ = [each for each in workers if each.state.depth and not each.failed]
            left = max_boxes - sum(each.state.boxes for each in workers)
            some = open_[: max(left, 0) // budget]
            list(pool.map(lambda each, count=budget: _examine(each, count, level), some))
            if any(each.state.status == ROUNDING for each in some):
                raise RuntimeError("the processor or the compiler does not round upward")
            found = [each.state for each in workers if each.state.lower > level]
            if found:
                found.sort(key=lambda each: -each.lower)
                some = [(each.lower, tuple(each.at)) for each in found]
                some[:_IMPROVED] = [uphill(kernel, box, *each) for each in some[:_IMPROVED]]
                return np.array([at for _, at in some])
    return np.empty((0, kernel.sides))


def _examine(worker: Worker, budget: int, level: float) -> None:
    """Examine about `budget` boxes, until none is left or an error above the level is found."""
    worker.state.budget = budget
    end = worker.state.boxes + budget
    while worker.state.depth and worker.state.boxes < end:
        worker.run()
        if worker.failed or worker.state.lower > level:
            return


def _cells(box: np.ndarray) -> Sequence[np.ndarray]:
    """Divide a box into equal cells, as often along each side."""
    count = max(round(_CELLS ** (1 / len(box))), 1)
    ends = [np.linspace(*side, count + 1) for side in box]
    for each, side in zip(ends, box, strict=True):
        each[[0, -1]] = side
    pieces = [np.stack([each[:-1], each[1:]], axis=1) for each in ends]
    return [np.array(cell) for cell in itertools.product(*pieces)]
