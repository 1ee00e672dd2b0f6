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
from itertools import pairwise
from math import inf

import numpy as np

from programs.bounding.branch_and_bound import BranchAndBound
from programs.bounding.compiled import (
    BUDGET,
    FINISHED,
    REFUTED,
    ROUNDING,
    STACK_FULL,
    Kernel,
    search_structure,
)
from programs.bounding.interval import enclose
from programs.program import Program

# A thread examines so many boxes before results are exchanged: about a tenth of a second.
_CHUNK = 100_000
# The box is divided into so many pieces for each thread at the start.
_PIECES = 8
_CAPACITY = 4096
# The largest error found is improved by so many rounds of so many steps.
_RADII, _STEPS = 16, 64


@dataclass(frozen=True)
class LargestValue:
    """Bounds of the largest |error| on a box: `lower`, attained at the point `at`, and `upper`.

    `boxes` is the number of boxes that were examined. `upper` is None if there is no proof. Then
    `at` is a point above the claim, or the place where the search gave up.
    """

    lower: float
    at: tuple[float, ...]
    upper: float | None
    boxes: int


@dataclass(frozen=True)
class Standing:
    """How far a search is: the proven part of the box, the boxes examined, and the seconds.

    `lower` is the largest |error| that was found.
    """

    part: float
    boxes: int
    seconds: float
    lower: float

    @property
    def remaining(self) -> float:
        """An estimate of the seconds that remain; infinite at the start."""
        return inf if self.part <= 0 else self.seconds * (1 - min(self.part, 1)) / self.part


Report = Callable[[Standing], None]


def _silent(_: Standing) -> None:
    pass


def bound_largest(
    kernel: Kernel,
    box: np.ndarray,
    ratio: float,
    *,
    claim: float | None = None,
    inexact: float = 0.0,
    seeds: np.ndarray | None = None,
    threads: int = 2,
    max_boxes: int = 10**10,
    progress: Report = _silent,
    leaves: np.ndarray | None = None,
) -> LargestValue:
    """Bound the largest |error| on a box from both sides, the bounds at most `ratio` apart.

    Arguments: `box` (sides, 2); `ratio`, above 1; `claim`, a bound to prove or to refute, in place
    of the best one; `inexact`, by how much the caller will move the bounds apart, for which the
    search leaves up to half of the room between them; `seeds` (n, sides), points where the error
    may be large; `threads`, the number of threads; `max_boxes`, after which the search gives up;
    `progress`, which is called several times a second; `leaves` (m, 2, sides), an array for the
    boxes of the proof, which needs one thread. Raises ValueError for a ratio that is not above 1,
    and RuntimeError if the processor does not round upward.
    """
    if not ratio > 1:
        raise ValueError(f"upper ratio {ratio:g}: allowed is a number above 1")
    began = time.monotonic()
    lower, at = _best_seed(kernel, box, seeds)
    if lower > 0:
        ratio -= min(2.05 * inexact / lower, (ratio - 1) / 2)
    workers = [Worker(kernel, box, ratio, claim) for _ in range(threads)]
    workers[0].found(lower, at)
    if leaves is not None:
        workers[0].keep(leaves)
    for k, piece in enumerate(_pieces(box, _PIECES * threads)):
        workers[k % threads].push(piece)
    with ThreadPoolExecutor(threads) as pool:
        while any(worker.state.depth for worker in workers):
            _share(workers)
            if claim is not None and workers[0].state.lower > claim:
                break
            list(pool.map(Worker.run, [each for each in workers if each.state.depth]))
            boxes = sum(worker.state.boxes for worker in workers)
            failed = [worker for worker in workers if worker.failed]
            if any(worker.state.status == ROUNDING for worker in failed):
                raise RuntimeError("the processor or the compiler does not round upward")
            best = max(workers, key=_lower).state
            if failed or boxes > max_boxes:
                where = failed[0].last() if failed else tuple(best.at)
                return LargestValue(best.lower, where, None, boxes)
            part = sum(worker.state.volume for worker in workers)
            progress(Standing(part, boxes, time.monotonic() - began, best.lower))
    best, boxes = max(workers, key=_lower).state, sum(worker.state.boxes for worker in workers)
    upper = None
    if claim is None or best.lower <= claim:
        upper = max(best.lower, *(worker.state.reached for worker in workers))
    lower, at = uphill(kernel, box, best.lower, tuple(best.at))
    if upper is not None and lower > upper:
        raise RuntimeError(f"an error of {lower!r} at {at} is above the proven bound {upper!r}")
    return LargestValue(lower, at, upper, boxes)


def bound_largest_slowly(
    program: Program, box: np.ndarray, ratio: float, *, seeds: np.ndarray | None = None
) -> LargestValue:
    """Do the same as `bound_largest` for the only output of a program, without a compiler.

    `box` is (inputs, 2), and `seeds` are places (n, inputs). It is about a hundred times slower. A
    selection is bounded by the hull of both its cases, so that no proof may be found for a program
    that has some.
    """
    if not ratio > 1:
        raise ValueError(f"upper ratio {ratio:g}: allowed is a number above 1")
    tried = box.mean(axis=1)[None] if seeds is None else np.clip(seeds, *box.T)

    def settled(below, above, least, most):
        return np.maximum(-below, above) <= ratio * max(-least, most)

    found = BranchAndBound().bound_output(program, box, (-inf, inf), settled, tried)
    (at_points,) = enclose(program, tried, tried)
    sizes = np.maximum(at_points.lower, -at_points.upper)
    best = int(np.argmax(np.nan_to_num(sizes, nan=-inf)))
    upper = max(-found.lower, found.upper)
    return LargestValue(
        max(float(sizes[best]), 0.0),
        tuple(tried[best].tolist()),
        float(upper) if np.isfinite(upper) else None,
        found.boxes,
    )


def _lower(worker: "Worker") -> float:
    return worker.state.lower


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


def uphill(
    kernel: Kernel, box: np.ndarray, lower: float, at: tuple[float, ...]
) -> tuple[float, tuple[float, ...]]:
    """Return a larger |error| near a point and its place, by random steps that become shorter.

    `box` (sides, 2) is not left. `lower` is the |error| at the point `at` (sides,).
    """
    rng, sides = np.random.default_rng(0), box[:, 1] - box[:, 0]
    for radius in np.geomspace(0.02, 1e-7, _RADII):
        for step in rng.normal(size=(_STEPS, kernel.sides)) * radius * sides:
            point = np.clip(np.array(at) + step, *box.T)
            low, high, *_ = kernel.enclose(np.stack([point, point], axis=1))
            size = max(low, -high)
            if lower < size < inf:
                lower, at = size, tuple(point.tolist())
    return lower, at


def _pieces(box: np.ndarray, count: int) -> Sequence[np.ndarray]:
    """Divide a box into `count` slabs along its first side."""
    ends = np.linspace(*box[0], count + 1)
    ends[0], ends[-1] = box[0]
    slabs = []
    for low, high in pairwise(ends):
        slab = box.copy()
        slab[0] = low, high
        slabs.append(slab)
    return slabs


class Worker:
    """The stack of boxes of one thread, and its search structure."""

    def __init__(self, kernel: Kernel, box: np.ndarray, ratio: float, claim: float | None):
        self.kernel, self.stack = kernel, np.empty((_CAPACITY, 2, kernel.sides))
        self.state = search_structure(kernel.sides)()
        self.state.budget = _CHUNK
        # With the ratio 0, the level stays at the claim.
        self.state.ratio = ratio if claim is None else 0.0
        self.state.level = claim or 0.0
        self.state.whole[:] = (box[:, 1] - box[:, 0]).tolist()

    @property
    def failed(self) -> bool:
        """Whether the search cannot go on."""
        return self.state.status not in (FINISHED, BUDGET, STACK_FULL, REFUTED)

    def found(self, lower: float, at: Sequence[float]) -> None:
        """Take note of an error that another search has found."""
        self.state.lower, self.state.at[:] = lower, list(at)
        self.state.level = max(self.state.level, lower * self.state.ratio)

    def keep(self, leaves: np.ndarray) -> None:
        """Copy the boxes of the proof to an array."""
        self.state.leaves = _pointer(leaves)
        self.state.leaf_capacity = len(leaves)

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
        self.state.capacity, self.state.stack = len(self.stack), _pointer(self.stack)
        self.kernel.library.shadefit_search(ctypes.byref(self.state))


def _pointer(array: np.ndarray):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def _share(workers: Sequence[Worker]) -> None:
    """Tell all threads the largest error that one has found, and give idle ones half a stack."""
    best = max(workers, key=_lower).state
    for worker in workers:
        worker.found(best.lower, tuple(best.at))
        richest = max(workers, key=lambda each: each.state.depth)
        if worker.state.depth == 0 and richest.state.depth > 1:
            # The bottom of a stack has the largest boxes.
            half = richest.state.depth // 2
            worker.stack = richest.stack.copy()
            worker.state.depth = half
            richest.stack = np.roll(richest.stack, -half, axis=0)
            richest.state.depth -= half
