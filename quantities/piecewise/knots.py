"""Knots of a piecewise-linear NDF that distribute its error equally over the segments."""

from collections.abc import Callable

import numpy as np

# The angles at which the second derivative is estimated; the part of the knots that is distributed
# equally over θ, so that no segment is very long; how many angles the estimate is averaged over.
_FINEST, _ANGLES, _EQUAL, _AVERAGED = 1e-4, 4001, 0.08, 25


def equidistributed_knots(
    of: Callable[[np.ndarray], np.ndarray], segments: int, variable: str = "cos2"
) -> np.ndarray:
    """Return `segments` + 1 angles from 0 to π/2 for the NDF D(θ) = `of(theta)`.

    On a segment of the width h, linear interpolation in the angle has an error of the order of
    |D″|h², or in cos²θ of |d²D/d(cos²θ)²| sin²2θ h². It is weighted by sin θ (cos θ + 3 sin θ): the
    first part is the measure of the total variation, the second serves Λ at grazing light. The
    knots have equal integrals of the third root. Raises ValueError for fewer than two segments.
    """
    if segments < 2:
        raise ValueError(f"{segments} segments: allowed are 2 and more")
    theta = np.concatenate([[0.0], np.geomspace(_FINEST, np.pi / 2, _ANGLES - 1)])
    values = np.asarray(of(theta), float)
    coordinate = theta if variable == "angle" else np.sin(theta) ** 2
    step = np.diff(coordinate)
    slope = np.diff(values) / np.where(step > 0, step, 1.0)
    middle = theta[1:-1]
    curvature = np.abs(np.diff(slope)) / ((step[1:] + step[:-1]) / 2)
    if variable != "angle":
        curvature = curvature * np.sin(2 * middle) ** 2
    weight = np.sin(middle) * (np.cos(middle) + 3 * np.sin(middle))
    density = np.cbrt(curvature * weight)
    density = np.convolve(
        np.pad(density, _AVERAGED, "edge"), np.ones(_AVERAGED) / _AVERAGED, "same"
    )
    density = np.interp(theta, middle, density[_AVERAGED:-_AVERAGED])
    total = np.concatenate([[0.0], np.cumsum(np.diff(theta) * (density[1:] + density[:-1]) / 2)])
    share = (1 - _EQUAL) * total / total[-1] + _EQUAL * theta / theta[-1]
    knots = np.interp(np.linspace(0, 1, segments + 1), share, theta)
    knots[0], knots[-1] = 0.0, np.pi / 2
    return knots
