"""How many points a quantity is fitted on, checked at and judged by, and where more are needed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np


def _ones(points: np.ndarray) -> np.ndarray:
    return np.ones(len(points))


@dataclass(frozen=True)
class Measure:
    """What errors at points (n, axes) count for: two functions of the points, each giving (n,).

    `density` weights squared errors in least squares fits. `largest` multiplies an error before
    the largest one is made least.
    """

    density: Callable[[np.ndarray], np.ndarray] = _ones
    largest: Callable[[np.ndarray], np.ndarray] = _ones


@dataclass(frozen=True)
class Sampling:
    """The base-2 logarithms of how many points a quantity's forms meet.

    Forms are `fitted` on 2^fitted points, searched for their largest error at 2^checked points,
    and judged by 2^judged. Half as many points more lie on the faces of the domain in the first
    two. `extra` maps points (n, axes) to further points where the quantity is steep.

    `climbs` says whether hill climbing looks for larger errors from the worst points; a quantity
    that is smooth and costly does without. `measures` are the weights that a fit may choose from,
    by name. `verified` limits the points at which exported code is compared with exact values.
    """

    fitted: int
    checked: int
    judged: int
    climbs: bool = True
    extra: Callable[[np.ndarray], np.ndarray] | None = None
    measures: Mapping[str, Measure] = field(default_factory=lambda: {"uniform": Measure()})
    verified: int | None = None
