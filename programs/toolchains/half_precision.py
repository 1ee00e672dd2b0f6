"""Whether half precision is good enough for a function: one rule for headers and for `verify`."""

from typing import TYPE_CHECKING

import numpy as np

from programs.toolchains.difference import Difference, two_digits

if TYPE_CHECKING:
    from programs.toolchains.verification import Trial

# Half precision is good enough if every value is finite and rounding moves none by more than this
# part of the largest value.
SHARE = 0.02
# The search for the largest effect of rounding: from so many of the worst points, so many steps to
# random neighbours, which begin at this part of the domain and become half as far each time.
_WORST, _NEIGHBOURS, _ROUNDS, _STEP = 256, 32, 4, 0.02
_SEED = 3


def half_allowed(trial: "Trial") -> Difference:
    """Return the difference from a trial's `form` with which half precision is good enough."""
    largest = SHARE * float(np.max(np.abs(trial.form)))
    return Difference(largest, largest, 0)


def half_rounding(trial: "Trial") -> Difference:
    """Return how far rounding to half moves values, with the largest distance searched uphill.

    The operations are emulated, each correctly rounded. The rms distance is that at the trial's own
    points, from the worst of which the search begins. A search may miss a worse point.
    """
    low, high = trial.points.min(axis=0), trial.points.max(axis=0)
    random = np.random.default_rng(_SEED)
    points, apart = trial.points, _apart(trial, trial.points)
    finite = np.isfinite(apart)
    lost = int(np.sum(~finite))
    rms = float(np.sqrt(np.mean(apart[finite] ** 2))) if finite.any() else 0.0
    largest = float(np.max(apart[finite], initial=0.0))
    for number in range(_ROUNDS):
        order = np.argsort(-np.where(np.isfinite(apart), apart, np.inf))[:_WORST]
        near = np.repeat(points[order], _NEIGHBOURS, axis=0)
        step = _STEP * 0.5**number * (high - low)
        points = np.clip(near + step * random.normal(size=near.shape), low, high)
        apart = _apart(trial, points)
        finite = np.isfinite(apart)
        lost = max(lost, int(np.sum(~finite)))
        largest = max(largest, float(np.max(apart[finite], initial=0.0)))
    return Difference(largest, rms, lost)


def verdict(trial: "Trial", apart: Difference) -> tuple[bool, str]:
    """Say whether half precision is good enough for a trial, and why.

    `apart` is the difference of the values of its code from `form`. The larger of it and of
    `half_rounding` counts.
    """
    searched, allowed = half_rounding(trial), half_allowed(trial)
    largest = max(apart.largest, searched.largest)
    lost = max(apart.not_finite, searched.not_finite)
    good = largest <= allowed.largest and not lost
    some = f", and {lost} values are not finite" if lost else ""
    return good, (
        f"rounding moves values by up to {two_digits(largest)}{some} (searched uphill; allowed: "
        f"{allowed.largest:.2g}, {SHARE:.0%} of the largest value)"
    )


def _apart(trial: "Trial", points: np.ndarray) -> np.ndarray:
    """Return how far rounding to half moves the value at each point, or the worst of the values."""
    half, exact = (trial.emulated_at(points, kind) for kind in (np.float16, np.float64))
    apart = np.abs(half - exact).reshape(len(points), -1)
    return np.where(np.isfinite(apart).all(axis=1), apart.max(axis=1), np.nan)
