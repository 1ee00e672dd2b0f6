"""Branch and bound: proven bounds of a program's output on a box, by interval arithmetic.

The box is divided into smaller boxes until the bounds on every one of them are good enough.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from programs.bounding.interval import enclose_with_slopes
from programs.program import Program, evaluate, reachable_values

# (below, above, least, most) -> (boxes,) bool: whether each box is good enough and need not be
# divided. `below` and `above` (boxes,) bound the output on each box; `least` and `most` are the
# extreme values that were found so far anywhere on the whole box.
Settled = Callable[[np.ndarray, np.ndarray, float, float], np.ndarray]


@dataclass(frozen=True)
class Bounds:
    """Proven bounds: every value lies between `lower` and `upper`, which are ∓∞ without a proof.

    `boxes` is the number of boxes that were examined.
    """

    lower: float
    upper: float
    boxes: int


@dataclass(frozen=True)
class BranchAndBound:
    """The solver and its limits.

    It gives up after `max_boxes` boxes, and when a box that is not settled is smaller than
    `smallest_box` times the whole box, since such a box may well contain a zero. `first_split` says
    into how many equal pieces the first sides of the box are divided at the start. This helps where
    the bounds on a long side are too wide to show which side to divide. `chunk` boxes are enclosed
    at a time, so that their intermediate values stay in the processor's cache.
    """

    max_boxes: int = 400_000
    smallest_box: float = 1e-9
    first_split: tuple[int, ...] = ()
    chunk: int = 2048

    def bound_output(
        self,
        program: Program,
        box: np.ndarray,
        allowed: tuple[float, float],
        settled: Settled,
        probes: np.ndarray | None = None,
    ) -> Bounds:
        """Bound the only output of a program on a box.

        Arguments: `box` (inputs, 2), the lower and the upper end of each side; `allowed`, the
        closed interval that all values must lie in; `settled`, which decides when a box need not be
        divided; `probes` (n, inputs), points at which values are tried first. A box is divided at
        the middle of the side that changes the output most. Returns the bounds. They are infinite
        when a value is found that is not allowed, or when the limits are reached. Raises ValueError
        for an operation that has no interval version, and for a `first_split` with more entries
        than the box has sides.
        """
        lower, upper = np.asarray(box, float).T
        low, high = _divide(lower, upper, self.first_split)
        # An input that the output does not depend on has infinite scale: it is never divided.
        used = np.array([k in reachable_values(program) for k in range(len(lower))])
        scale = np.where(used, (high - low)[0], np.inf)
        # Values are evaluated at the middle of every box. The corners of the whole box, where the
        # extreme values often are, would never be among these points, so they are added here.
        points = np.array(list(product(*zip(lower, upper, strict=True))))
        points = points if probes is None else np.concatenate([points, probes])
        least, most = np.inf, -np.inf
        lowest, highest, boxes = np.inf, -np.inf, 0
        while len(low):
            values = evaluate(program, np.concatenate([points, (low + high) / 2]))
            # np.minimum, unlike min, returns NaN if one of the values is NaN.
            least, most = np.minimum(least, values.min()), np.maximum(most, values.max())
            boxes += len(low)
            smallest = np.min(np.max((high - low) / scale, axis=1))
            if not allowed[0] <= least <= most <= allowed[1] or boxes > self.max_boxes:
                return Bounds(-np.inf, np.inf, boxes)
            if smallest < self.smallest_box:
                return Bounds(-np.inf, np.inf, boxes)
            below, above, effect = self._enclose(program, low, high)
            done = settled(below, above, least, most)
            lowest = min(lowest, below[done].min(initial=np.inf))
            highest = max(highest, above[done].max(initial=-np.inf))
            low, high, effect = low[~done], high[~done], effect[~done]
            known = np.isfinite(effect).all(axis=1, keepdims=True)
            low, high = _halve(low, high, np.where(known, effect, (high - low) / scale))
        return Bounds(float(lowest), float(highest), boxes)

    def _enclose(
        self, program: Program, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Return bounds (boxes,) of the output and the effect of each input on it (boxes, inputs).

        The effect is the largest slope on the box, multiplied by the length of the side.
        """
        below, above, slopes = [], [], []
        for first in range(0, len(low), self.chunk):
            some = slice(first, first + self.chunk)
            (found,) = enclose_with_slopes(program, low[some], high[some])
            below.append(found.value.lower)
            above.append(found.value.upper)
            slopes.append(np.maximum(-found.gradient.lower, found.gradient.upper).T)
        return np.concatenate(below), np.concatenate(above), np.concatenate(slopes) * (high - low)


def _divide(
    lower: np.ndarray, upper: np.ndarray, counts: tuple[int, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Divide each of the first sides of a box into `counts` equal pieces: lower and upper ends."""
    if len(counts) > len(lower):
        raise ValueError(f"first_split is {counts}; allowed: at most {len(lower)} counts")
    counts = counts + (1,) * (len(lower) - len(counts))
    ends = [np.linspace(*each) for each in zip(lower, upper, np.array(counts) + 1, strict=True)]
    low = np.array(list(product(*(each[:-1] for each in ends))))
    return low, np.array(list(product(*(each[1:] for each in ends))))


def _halve(low: np.ndarray, high: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Divide every box at the middle of one side: the side of largest `size` (boxes, inputs)."""
    side = np.argmax(size, axis=1)
    rows = np.arange(len(low))
    middle = (low[rows, side] + high[rows, side]) / 2
    left_high, right_low = high.copy(), low.copy()
    left_high[rows, side] = right_low[rows, side] = middle
    return np.concatenate([low, right_low]), np.concatenate([left_high, high])
