"""Points all over a domain: a largest error is as often on its boundary as inside.

G is steep as d and ν fall, and P_s about the fibre at the scale of α: there are more points there.
"""

from dataclasses import dataclass

import numpy as np

from fitting.points.grids import off_grid_points
from integrals import Axis


@dataclass(frozen=True)
class Counts:
    """log₂ of how many points a quantity's forms are fitted on, checked at, and judged by.

    `spread_points` adds half as many on the faces. `climbs` says whether larger errors are sought
    uphill from the worst: not of R, which is smooth in its two variables and dear.
    """

    fitted: int
    checked: int
    judged: int
    climbs: bool = True


COUNTS = {
    "ps": Counts(fitted=13, checked=15, judged=17),
    "g": Counts(fitted=13, checked=15, judged=16),
    "q": Counts(fitted=11, checked=13, judged=16),
    "r": Counts(fitted=11, checked=10, judged=12, climbs=False),
    "velvet": Counts(fitted=11, checked=13, judged=16),
}
# Points that are stretched beyond the domain by this and put back lie on its faces.
STRETCH = 1.25
# P_s varies within this many α of the fibre's direction.
RING = 5.0


def spread_points(name: str, axes: tuple[Axis, ...], exponent: int, seed: int) -> np.ndarray:
    """Give 2^exponent points inside a domain, half as many on its faces, and where it is steep."""
    lower = np.array([axis.lower for axis in axes])
    width = np.array([axis.upper for axis in axes]) - lower
    inside = (off_grid_points(axes, exponent, seed) - lower) / width
    faces = (off_grid_points(axes, exponent - 1, seed + 1) - lower) / width
    unit = np.concatenate([inside, np.clip((faces - 0.5) * STRETCH + 0.5, 0, 1)])
    if name == "g":
        # Even in the logarithms of d and ν.
        return lower * (1 + width / lower) ** unit
    if name == "q":
        unit = unit**2
    points = lower + width * unit
    return np.concatenate([points, _rings(points)]) if name == "ps" else points


def _rings(points: np.ndarray) -> np.ndarray:
    """Move the lights of points (α, θf, θu, φ) to within RING α of the fibre, above the surface."""
    alpha, theta_f, theta_u, phi = points.T
    distance = RING * alpha * (theta_u / (np.pi / 2)) ** 1.5
    fibre = np.stack([np.sin(theta_f), 0 * theta_f, np.cos(theta_f)])
    across = np.stack([np.cos(theta_f), 0 * theta_f, -np.sin(theta_f)])
    side = np.array([0.0, 1.0, 0.0])[:, None]
    around = np.cos(phi) * across + np.sin(phi) * side
    x, y, z = np.cos(distance) * fibre + np.sin(distance) * around
    theta = np.arctan2(np.hypot(x, y), np.maximum(z, 0))
    return np.stack([alpha, theta_f, np.minimum(theta, np.pi / 2), np.arctan2(y, x)], axis=1)
