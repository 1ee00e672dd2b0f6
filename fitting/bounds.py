"""Bounds of a form's values: the integrals are fractions, and so should be what stands for them."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from fitting.certificate import as_program, split, traced
from fitting.form import Form
from fitting.interval import enclose_with_slopes
from fitting.spread import spread_points
from integrals import Axis
from programs.program import Program, evaluate

# Bounds are within this of values that are attained.
TIGHTNESS = 1e-3
MAX_BOXES = 400_000
# Boxes that are enclosed at once: what is computed of them stays in the cache.
CHUNK = 2048
# Bounds are rounded outwards at each step: a form that is one somewhere has a bound above it.
ROUNDING = 1e-12
FRACTIONS = (-ROUNDING, 1 + ROUNDING)
# The same of margins, which are sums and products: none that is zero is rounded below this.
MARGINS = (-1e-300, np.inf)
# log₂ of the number of points that are tried first: a form that leaves [0, 1] often does so there.
PROBES = 12
# Of margins α and θf are divided first: κ = (1 − α)(1 + α) is above one for a wide interval of α.
MATERIALS = (64, 8)


@dataclass(frozen=True)
class Range:
    """Every value on the whole domain is from `lower` to `upper`; `boxes` were needed to prove it.

    Where a form is not what the proof is about but its margins, they are 0 and 1.
    """

    lower: float
    upper: float
    boxes: int


def certify_range(form: Form) -> Range | None:
    """Prove that all values of a form lie between 0 and 1; None where that is not shown.

    Of a form that gives its margins these are shown not to be negative. Of others the values are
    bounded, to within `TIGHTNESS` of what is attained.
    """
    margins = form.margins()
    if margins is None:
        points = spread_points(form.integral.name, form.axes, PROBES, PROBES)
        return bound_values(as_program(form), *_box(form.axes), FRACTIONS, TIGHTNESS, points)
    call, axes = margins
    boxes = 0
    for k in range(len(call(*(axis.lower for axis in axes)))):
        program = traced(form, lambda *x, k=k: call(*x)[k], axes)
        found = bound_values(program, *_box(axes), MARGINS, pieces=MATERIALS)
        if found is None:
            return None
        boxes += found.boxes
    return Range(0.0, 1.0, boxes)


def bound_values(
    program: Program,
    lower: np.ndarray,
    upper: np.ndarray,
    allowed: tuple[float, float],
    tightness: float = np.inf,
    probes: np.ndarray | None = None,
    pieces: tuple[int, ...] = (),
) -> Range | None:
    """Bound a program's output on the box [lower, upper], by branch and bound.

    The bounds are within `allowed` and within `tightness` of values that are attained. None where
    a value is found that is not allowed, or more than MAX_BOXES boxes are needed. The search
    starts from `pieces` of the first sides; `probes` (n, inputs) are tried before it.
    """
    low, high = _pieces(lower, upper, pieces)
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
        if not allowed[0] <= least <= most <= allowed[1] or boxes > MAX_BOXES:
            return None
        below, above, effect = _enclosed(program, low, high)
        done = (below >= max(allowed[0], least - tightness)) & (
            above <= min(allowed[1], most + tightness)
        )
        lowest = min(lowest, below[done].min(initial=np.inf))
        highest = max(highest, above[done].max(initial=-np.inf))
        low, high, effect = low[~done], high[~done], effect[~done]
        known = np.isfinite(effect).all(axis=1, keepdims=True)
        low, high = split(low, high, np.where(known, effect, (high - low) / (upper - lower)))
    return Range(float(lowest), float(highest), boxes)


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


def _box(axes: tuple[Axis, ...]) -> tuple[np.ndarray, np.ndarray]:
    return np.array([axis.lower for axis in axes]), np.array([axis.upper for axis in axes])
