"""The largest absolute value of an error function on a box: a lower bound, attained, and a theorem.

The search proves |error| ≤ level on ever smaller boxes, depth first, so that it needs little
memory. The level is a fixed ratio above the largest value found so far. Each value that is found is
a bound that holds, since it is computed in interval arithmetic.
"""

import ctypes
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import inf

import numpy as np

from programs.bounding.compiled import BUDGET, FINISHED, STACK_FULL, Kernel, search_structure
from programs.bounding.compiled import ROUNDING as _ROUNDING

# So many boxes are examined by a thread before results are exchanged, about a tenth of a second.
_CHUNK = 100_000
# The box is divided into so many pieces for each thread at the start.
_PIECES = 8
_CAPACITY = 4096


@dataclass(frozen=True)
class LargestValue:
    """Bounds of the largest |error| on a box: `lower`, attained at the point `at`, and `upper`.

    `boxes` is the number of boxes that were examined. `upper` is None if the search gave up, at
    `at` or after too many boxes.
    """

    lower: float
    at: tuple[float, ...]
    upper: float | None
    boxes: int


@dataclass(frozen=True)
class Standing:
    """How far a search is: the proven part of the box, the boxes examined, and the seconds."""

    part: float
    boxes: int
    seconds: float
    lower: float

    @property
    def remaining(self) -> float:
        """An estimate of the seconds that remain; infinite at the start."""
        return inf if self.part <= 0 else self.seconds * (1 - min(self.part, 1)) / self.part


def bound_largest(
    kernel: Kernel,
    box: np.ndarray,
    ratio: float,
    *,
    seeds: np.ndarray | None = None,
    threads: int = 2,
    max_boxes: int = 10**10,
    progress: Callable[[Standing], None] = lambda _: None,
) -> LargestValue:
    """Bound the largest |error| on a box from both sides, the bounds at most `ratio` apart.

    Arguments: `box` (sides, 2); `ratio`, above 1; `seeds` (n, sides), points where the error may be
    large; `threads`, the number of threads; `max_boxes`, after which the search gives up;
    `progress`, which is called about ten times a second. Raises ValueError for a ratio that is not
    above 1, and RuntimeError if the processor does not round upward.
    """
    if not ratio > 1:
        raise ValueError(f"upper ratio {ratio:g}: allowed is a number above 1")
    began = time.monotonic()
    lower, at = _best_seed(kernel, box, seeds)
    workers = [_Worker(kernel, box, ratio, lower, at) for _ in range(threads)]
    for k, piece in enumerate(_pieces(box, _PIECES * threads)):
        workers[k % threads].push(piece)
    with ThreadPoolExecutor(threads) as pool:
        while any(worker.state.depth for worker in workers):
            _share(workers)
            list(pool.map(_Worker.run, [each for each in workers if each.state.depth]))
            lower, at = max(((w.state.lower, tuple(w.state.at)) for w in workers), key=_first)
            boxes = sum(worker.state.boxes for worker in workers)
            stuck = [worker for worker in workers if worker.failed]
            if any(worker.state.status == _ROUNDING for worker in workers):
                raise RuntimeError("the processor or the compiler does not round upward")
            if stuck or boxes > max_boxes:
                where = stuck[0].last() if stuck else at
                return LargestValue(max(lower, 0.0), where, None, boxes)
            part = sum(worker.state.volume for worker in workers)
            progress(Standing(part, boxes, time.monotonic() - began, lower))
    upper = max(worker.state.reached for worker in workers)
    return LargestValue(lower, at, upper, sum(worker.state.boxes for worker in workers))


def _first(pair: tuple) -> float:
    return pair[0]


def _best_seed(
    kernel: Kernel, box: np.ndarray, seeds: np.ndarray | None
) -> tuple[float, tuple[float, ...]]:
    """Return the largest proven |error| at the seeds and the middle of the box, and its place."""
    points = box.mean(axis=1)[None]
    if seeds is not None:
        points = np.concatenate([points, np.clip(seeds, *box.T)])
    best = 0.0, tuple(points[0].tolist())
    for point in points:
        low, high, *_ = kernel.enclose(np.stack([point, point], axis=1))
        size = max(low, -high)
        if best[0] < size < inf:
            best = size, tuple(point.tolist())
    return best


def _pieces(box: np.ndarray, count: int) -> Sequence[np.ndarray]:
    """Divide a box into `count` equal slabs along its first side."""
    ends = np.linspace(*box[0], count + 1)
    ends[0], ends[-1] = box[0]
    slabs = []
    for low, high in zip(ends[:-1], ends[1:], strict=True):
        slab = box.copy()
        slab[0] = low, high
        slabs.append(slab)
    return slabs


class _Worker:
    """The stack of boxes of one thread, and its search structure."""

    def __init__(self, kernel: Kernel, box: np.ndarray, ratio: float, lower: float, at: tuple):
        self.kernel, self.stack = kernel, np.empty((_CAPACITY, 2, kernel.sides))
        self.state = search_structure(kernel.sides)()
        self.state.budget, self.state.ratio = _CHUNK, ratio
        self.state.lower, self.state.level = lower, lower * ratio
        self.state.at[:] = at
        self.state.whole[:] = (box[:, 1] - box[:, 0]).tolist()

    @property
    def failed(self) -> bool:
        """Whether the search cannot go on."""
        return self.state.status not in (FINISHED, BUDGET, STACK_FULL)

    def push(self, box: np.ndarray) -> None:
        """Put a box (sides, 2) on the stack."""
        self.stack[self.state.depth] = box.T
        self.state.depth += 1

    def last(self) -> tuple[float, ...]:
        """Return the middle of the box on top of the stack."""
        return tuple(self.stack[self.state.depth - 1].mean(axis=0).tolist())

    def run(self) -> None:
        """Examine boxes until the stack is empty or the budget is used up."""
        if self.state.status == STACK_FULL:
            self.stack = np.concatenate([self.stack, np.empty_like(self.stack)])
        self.state.capacity = len(self.stack)
        number = ctypes.c_double
        self.state.stack = self.stack.ctypes.data_as(ctypes.POINTER(number))
        self.kernel.library.shadefit_search(ctypes.byref(self.state))


def _share(workers: Sequence[_Worker]) -> None:
    """Tell all threads the largest error that one has found, and give idle ones half a stack."""
    best = max(workers, key=lambda worker: worker.state.lower).state
    for worker in workers:
        worker.state.lower, worker.state.at[:] = best.lower, list(best.at)
        worker.state.level = max(worker.state.level, best.lower * best.ratio)
        richest = max(workers, key=lambda each: each.state.depth)
        if worker.state.depth == 0 and richest.state.depth > 1:
            # The bottom of a stack has the largest boxes.
            given, rest = np.split(richest.stack[: richest.state.depth], [richest.state.depth // 2])
            worker.stack[: len(given)] = given
            worker.state.depth = len(given)
            richest.stack[: len(rest)] = rest.copy()
            richest.state.depth = len(rest)
