"""Algorithms 1 and 2 of *A Piecewise-Linear NDF* as printed, to show where they do not end.

They run in the precision of `kind`. `shading.piecewise.normal_sampling` has samplers of the same
normals that end after a fixed number of steps in any precision.
"""

from typing import NamedTuple

import numpy as np

from integrals.piecewise.published import tabulated_masses
from shading.piecewise.blend import Blend, weights

TOLERANCE = 1e-5


class Draw(NamedTuple):
    """An angle in radians, and the number of steps; the last value is None if it did not end."""

    angle: float
    steps: int | None


def algorithm_1(
    ndf: Blend, sample: float, *, kind: type[np.floating] = np.float64, most: int = 200
) -> Draw:
    """Draw an azimuth φ from a number in [0, 1), by at most `most` steps (Alg. 1)."""
    x, y = (float(each) for each in weights(ndf))
    bend, turn, xi = kind(x - y), kind(2 * np.pi), kind(sample)
    quarter = int(4 * sample)
    low, high = kind(quarter) * turn / kind(4), kind(quarter + 1) * turn / kind(4)
    phi = xi * turn
    for step in range(most):
        if not low <= phi <= high:
            phi = kind(0.5) * (low + high)
        value = phi / turn + bend / (kind(2) * turn) * np.sin(kind(2) * phi) - xi
        if abs(value) < TOLERANCE:
            return Draw(float(phi), step)
        low, high = (low, phi) if value > 0 else (phi, high)
        phi = phi - value / ((kind(1) + bend * np.cos(kind(2) * phi)) / turn)
    return Draw(float(phi), None)


def algorithm_2(
    ndf: Blend,
    phi: float,
    sample: float,
    *,
    kind: type[np.floating] = np.float64,
    tolerance: float = TOLERANCE,
    most: int = 200,
) -> Draw:
    """Draw a polar angle θ at azimuth φ from a number in [0, 1), by at most `most` steps (Alg. 2).

    Both profiles have the same knots, between which D is linear in θ. The printed `tolerance` is an
    absolute one of an integral whose terms are of the order of D(0)², so that rounding in float32
    can keep it from being reached.
    """
    x, y = (float(each) for each in weights(ndf))
    along, across = np.cos(phi) ** 2, np.sin(phi) ** 2
    knots = np.asarray(ndf.x.knots)
    c = float(ndf.x.values[0] + ndf.y.values[0]) / 2
    # Alg. 2 does not divide by c: its numbers are of the order of D(0)².
    values = 2 * c * (x * along * np.asarray(ndf.x.values) + y * across * np.asarray(ndf.y.values))
    cdf = 2 * (x * along * tabulated_masses(ndf.x) + y * across * tabulated_masses(ndf.y))
    xi = sample * cdf[-1]
    k = int(np.clip(np.searchsorted(cdf, xi, side="right") - 1, 0, len(knots) - 2))
    slope = (values[k + 1] - values[k]) / (knots[k + 1] - knots[k])
    a, b = kind(slope), kind(values[k] - slope * knots[k])
    # Eq. 9 in the notation of Alg. 2, whose b in C = b(ξ′ − cdf)/2π is the c of Eq. 1.
    goal = kind(c * (xi - cdf[k]) / (2 * np.pi))
    start, low, high = (kind(each) for each in (knots[k], knots[k], knots[k + 1]))
    rise = (cdf[k + 1] - cdf[k]) / (knots[k + 1] - knots[k])
    theta = kind(knots[k] + (xi - cdf[k]) / rise)
    two = kind(2)
    for step in range(most):
        if not low <= theta <= high:
            theta = kind(0.5) * (low + high)
        value = two * (a * start + b) * np.cos(two * start)
        value = value - two * (a * theta + b) * np.cos(two * theta)
        value = value + a * (np.sin(two * theta) - np.sin(two * start))
        value = value / kind(8) - goal
        if abs(value) < tolerance:
            return Draw(float(theta), step)
        low, high = (low, theta) if value > 0 else (theta, high)
        theta = theta - value / ((a * theta + b) / two * np.sin(two * theta))
    return Draw(float(theta), None)
