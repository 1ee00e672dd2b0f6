"""Branch and bound: proven bounds of a program's output on a box, by interval arithmetic."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from programs.bounding.interval import enclose_with_slopes
from programs.program import Program, evaluate, reachable_values

MAX_BOXES = 400_000
# A box that has shrunk to this part of the first and is not settled may well hold a zero.
SMALLEST_BOX = 1e-9
# Of P_s α and θf are divided first: κ = (1 − α)(1 + α) is above one for a wide interval of α.
MATERIALS = (64, 8)
# Boxes that are enclosed at once: what is computed of them stays in the cache.
CHUNK = 2048

# (below, above, least, most) → which boxes need not be split: `below` and `above` (boxes,) bound
# the output on each, `least` and `most` are attained somewhere on the whole box.
Settled = Callable[[np.ndarray, np.ndarray, float, float], np.ndarray]


@dataclass(frozen=True)
class Bounds:
    """Every value lies from `lower` to `upper`; `boxes` were looked at. ∓∞: it is not shown."""

    lower: float
    upper: float
    boxes: int


def bound_output(
    program: Program,
    box: np.ndarray,
    allowed: tuple[float, float],
    settled: Settled,
    probes: np.ndarray | None = None,
) -> Bounds:
    """Bound a program's only output on a box (inputs, 2) of lower and upper ends.

    Nothing is shown where a value is found that is not `allowed`, or where boxes within the limits
    on their number and size do not settle it. `probes` (n, inputs) are tried first. A box is split
    along the side that matters most.
    """
    lower, upper = np.asarray(box, float).T
    low, high = _pieces(lower, upper, MATERIALS if len(lower) > len(MATERIALS) else ())
    # An input that the output does not depend on is never split.
    used = np.array([k in reachable_values(program) for k in range(len(lower))])
    scale = np.where(used, (high - low)[0], np.inf)
    # No box's middle is a corner of the domain, where values are often the least and the largest.
    points = np.array(list(product(*zip(lower, upper, strict=True))))
    points = points if probes is None else np.concatenate([points, probes])
    least, most = np.inf, -np.inf
    lowest, highest, boxes = np.inf, -np.inf, 0
    while len(low):
        values = evaluate(program, np.concatenate([points, (low + high) / 2]))
        # np.minimum, unlike min, keeps a NaN
        least, most = np.minimum(least, values.min()), np.maximum(most, values.max())
        boxes += len(low)
        smallest = np.min(np.max((high - low) / scale, axis=1))
        if not allowed[0] <= least <= most <= allowed[1] or boxes > MAX_BOXES:
            return Bounds(-np.inf, np.inf, boxes)
        if smallest < SMALLEST_BOX:
            return Bounds(-np.inf, np.inf, boxes)
        below, above, effect = _enclosed(program, low, high)
        done = settled(below, above, least, most)
        lowest = min(lowest, below[done].min(initial=np.inf))
        highest = max(highest, above[done].max(initial=-np.inf))
        low, high, effect = low[~done], high[~done], effect[~done]
        known = np.isfinite(effect).all(axis=1, keepdims=True)
        low, high = _split(low, high, np.where(known, effect, (high - low) / scale))
    return Bounds(float(lowest), float(highest), boxes)


def _pieces(lower, upper, counts: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Divide a box into so many equal pieces along its first sides."""
    counts = counts + (1,) * (len(lower) - len(counts))
    ends = [np.linspace(*each) for each in zip(lower, upper, np.array(counts) + 1, strict=True)]
    low = np.array(list(product(*(each[:-1] for each in ends))))
    return low, np.array(list(product(*(each[1:] for each in ends))))


def _enclosed(program: Program, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, ...]:
    """Give bounds (boxes,) of the output, and how much each input may change it (boxes, inputs)."""
    below, above, slopes = [], [], []
    for first in range(0, len(low), CHUNK):
        some = slice(first, first + CHUNK)
        (found,) = enclose_with_slopes(program, low[some], high[some])
        below.append(found.value.lower)
        above.append(found.value.upper)
        slopes.append(np.maximum(-found.gradient.lower, found.gradient.upper).T)
    return np.concatenate(below), np.concatenate(above), np.concatenate(slopes) * (high - low)


def _split(low: np.ndarray, high: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split every box in two along its longest side: of those of largest `size` (boxes, inputs)."""
    side = np.argmax(size, axis=1)
    rows = np.arange(len(low))
    middle = (low[rows, side] + high[rows, side]) / 2
    left_high, right_low = high.copy(), low.copy()
    left_high[rows, side] = right_low[rows, side] = middle
    return np.concatenate([low, right_low]), np.concatenate([left_high, high])
