"""How many points forms are fitted on, checked at and judged by, and how errors are weighted."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np


def _ones(points: np.ndarray) -> np.ndarray:
    return np.ones(len(points))


@dataclass(frozen=True)
class Measure:
    """The weight of an error at each point: two functions from points (n, axes) to weights (n,).

    A least-squares fit multiplies the squared error by `density`. A fit that minimises the largest
    error multiplies the error by `largest`.
    """

    density: Callable[[np.ndarray], np.ndarray] = _ones
    largest: Callable[[np.ndarray], np.ndarray] = _ones


@dataclass(frozen=True)
class Sampling:
    """The numbers of points at which the forms of a quantity are evaluated, as base-2 logarithms.

    A form is fitted on 2^`fitted` points, its largest error is searched for at 2^`checked` points,
    and it is judged by 2^`judged` points. Fitting and checking add half as many points on the faces
    of the domain. `extra` is a function from points (n, axes) to further points in regions where
    the quantity is steep.

    If `climbs` is true, hill climbing starts at the worst points and looks for larger errors. This
    is not worth its time for a quantity that is smooth and expensive. Of such a quantity, a fit of
    the largest error still climbs, but tries at most `refined` points in a round; 0 stands for no
    climbing.

    `measures` are the weights that a fit may choose from, by name. `verified` is the largest number
    of points (not a logarithm) at which exported code is compared with exact values. None means no
    limit.
    """

    fitted: int
    checked: int
    judged: int
    climbs: bool = True
    refined: int = 0
    extra: Callable[[np.ndarray], np.ndarray] | None = None
    measures: Mapping[str, Measure] = field(default_factory=lambda: {"uniform": Measure()})
    verified: int | None = None
