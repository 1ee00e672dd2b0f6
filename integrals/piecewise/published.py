"""The integrals of *A Piecewise-Linear NDF* as the paper prints them, with its errata applied.

The functions are for comparison: `smith` computes the same values without the tables of partial
sums T and A, and without cancellation. They use NumPy in float64 and take one direction. Both
profiles of a blend have the same knots, D is linear in θ between them, and both are normalised.
docs/piecewise-ndf.md lists the errata. The notation is the paper's: a and b of D = aθ + b on a
segment, E = π/2 − θo, and C = arccos(−cot θo cot θ).
"""

import itertools
from typing import NamedTuple

import numpy as np

from shading.piecewise.blend import Blend
from shading.piecewise.ndf import Profile


class Partial(NamedTuple):
    """The parts of the visible projected area that the paper integrates one by one.

    `front` is I₁ (Eq. 16), `back` I₂¹ (Eq. 23), and `rim` I₂² (Eq. 26 and 27 or 28). Their sum is
    ∫ max(o·m, 0) D dω.
    """

    front: float
    back: float
    rim: float


def isotropic_mass(ndf: Profile) -> float:
    """Return c_iso of a profile that is linear in θ, by Eq. 5 as printed."""
    return float(np.sum(_masses(*_segments(ndf))))


def partial_moment(ndf: Profile, upper: float = np.pi / 2) -> float:
    """Return ∫₀^upper D sin²θ dθ: Aⁿ (Eq. 15), and its part below E in Eq. 23."""
    a, b, left, right = _segments(ndf, 0.0, upper)
    total = (
        a * np.cos(2 * left)
        - a * np.cos(2 * right)
        + 2 * (right - left) * (2 * b + a * (left + right))
        + 2 * (b + a * left) * np.sin(2 * left)
        - 2 * (b + a * right) * np.sin(2 * right)
    )
    return float(np.sum(total) / 8)


def partial_mass(ndf: Profile, lower: float, upper: float) -> float:
    """Return 2π ∫ D cos θ sin θ dθ from `lower` to `upper`: the sums T of Eq. 9, 23 and 26."""
    return float(np.sum(_masses(*_segments(ndf, lower, upper))))


def tabulated_masses(ndf: Profile) -> np.ndarray:
    """Return T (n,), the mass below each knot (Eq. 9)."""
    return np.concatenate([[0.0], np.cumsum(_masses(*_segments(ndf)))])


def visible_area(ndf: Blend, theta_o: float, phi_o: float, *, trapezoid: bool = False) -> Partial:
    """Return I₁, I₂¹ and I₂² for the direction (θo, φo), 0 < θo < π/2, in radians.

    The integral over θ that has no closed form (Eq. 27) is computed by the trapezoid rule of Eq. 28
    if `trapezoid` is true, and else by Gauss points in a variable in which it is smooth.
    """
    edge, sine, cosine = np.pi / 2 - theta_o, np.sin(theta_o), np.cos(theta_o)
    turn = np.cos(2 * phi_o)
    x, y = float(ndf.x.values[0]), float(ndf.y.values[0])
    c = (x + y) / 2
    parts = [(y / c, 1.0, ndf.x), (x / c, -1.0, ndf.y)]
    front = cosine / 2
    back = rim = 0.0
    for factor, sign, profile in parts:
        lean = 3 + sign * turn
        front += sine * factor * lean / 3 * partial_moment(profile)
        back += -sine * factor * lean / 3 * partial_moment(profile, edge)
        back += cosine / 4 * factor * partial_mass(profile, 0.0, edge)
        rim += -cosine / 4 * factor * partial_mass(profile, edge, np.pi / 2)
        integral = _trapezoid if trapezoid else _gauss
        rim += factor * integral(profile, theta_o, sign * turn)
    return Partial(front, back, rim)


def masking(ndf: Blend, theta_o: float, phi_o: float, *, trapezoid: bool = False) -> float:
    """Return G1 by Eq. 29, which exceeds 1 for some profiles if `trapezoid` is true."""
    return float(np.cos(theta_o) / sum(visible_area(ndf, theta_o, phi_o, trapezoid=trapezoid)))


def _integrand(theta: np.ndarray, theta_o: float, turn: float) -> tuple[np.ndarray, np.ndarray]:
    """Return part1 and part2 of Eq. 28 without D."""
    cosine = -1 / (np.tan(theta_o) * np.tan(theta))
    azimuth = np.arccos(np.clip(cosine, -1, 1))
    sine = np.sin(azimuth)
    first = np.sin(theta) ** 2 * (3 + turn * (np.cos(2 * azimuth) - 2 * sine)) * (sine - 1)
    second = np.cos(theta) * np.sin(theta) * (azimuth + np.sin(2 * azimuth) * turn / 2)
    return first, second


def _trapezoid(ndf: Profile, theta_o: float, turn: float) -> float:
    knots = np.asarray(ndf.knots)
    edge = np.pi / 2 - theta_o
    theta = np.concatenate([[edge], knots[knots > edge]])
    values = np.interp(theta, knots, np.asarray(ndf.values))
    first, second = _integrand(theta, theta_o, turn)
    both = values * (np.sin(theta_o) / 3 * first + np.cos(theta_o) * second)
    return float(np.sum(np.diff(theta) * (both[1:] + both[:-1]) / 2))


def _gauss(ndf: Profile, theta_o: float, turn: float, nodes: int = 40) -> float:
    knots = np.asarray(ndf.knots)
    edge = np.pi / 2 - theta_o
    ends = np.concatenate([[edge], knots[knots > edge]])
    x, weight = np.polynomial.legendre.leggauss(nodes)
    total = 0.0
    for left, right in itertools.pairwise(ends):
        # The azimuth C has a root at E: y² makes the integrand smooth. It is nearly singular in the
        # next segments, of which the distances to E are therefore squares as well.
        low, high = np.sqrt(left - edge), np.sqrt(right - edge)
        y = low + (high - low) * (x + 1) / 2
        theta = edge + y * y
        first, second = _integrand(theta, theta_o, turn)
        values = np.interp(theta, knots, np.asarray(ndf.values))
        both = values * (np.sin(theta_o) / 3 * first + np.cos(theta_o) * second)
        total += np.sum(weight * (high - low) / 2 * 2 * y * both)
    return float(total)


def _masses(a: np.ndarray, b: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return 2π ∫ (aθ + b) cos θ sin θ dθ between the ends of each segment, as in Eq. 5."""
    total = (
        2 * (a * left + b) * np.cos(2 * left)
        - 2 * (a * right + b) * np.cos(2 * right)
        + a * (np.sin(2 * right) - np.sin(2 * left))
    )
    return np.pi / 4 * total


def _segments(
    ndf: Profile, lower: float = 0.0, upper: float = np.pi / 2
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return a, b and the ends of the parts of the segments that are between two angles."""
    knots, values = np.asarray(ndf.knots), np.asarray(ndf.values)
    a = np.diff(values) / np.diff(knots)
    b = values[:-1] - a * knots[:-1]
    return a, b, np.clip(knots[:-1], lower, upper), np.clip(knots[1:], lower, upper)
