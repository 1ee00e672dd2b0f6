"""Bounds of what rules and interpolants leave out of R, from its values at complex arguments.

docs/r-theorem.md proves every formula here. A function that is analytic and bounded by M in the
ellipse with the foci ±1 and the sum ρ of its half axes has Chebyshev coefficients of at most 2Mρ⁻ᵏ.
So each bound is the minimum over ρ of a formula that holds for every ρ. The formulas are evaluated
in float64, and the results are multiplied by `SAFETY`, which is far more than rounding.
"""

import functools
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

SAFETY = 1.001
# Nodes of the rule in each panel, a multiple of eight
NODES = 16
_RHO = np.geomspace(1.05, 12.0, 64)
# The half axes of the ellipses: real and imaginary
_REAL, _IMAGINARY = (_RHO + 1 / _RHO) / 2, (_RHO - 1 / _RHO) / 2
_POWERS = _RHO[:, None] ** -np.arange(2.0 * NODES)
_HALVINGS = 16


def lebesgue(nodes: int) -> float:
    """Return a bound of the Lebesgue constant of `nodes` Chebyshev nodes of the first kind."""
    return 2 / np.pi * np.log(nodes) + 1


def _interpolation(bound: np.ndarray, nodes: int) -> float:
    """Return the least of 4Mρ⁻ⁿ/(ρ − 1) with n = nodes − 1, for a bound M for each ρ."""
    return SAFETY * float(np.min(4 * bound * _RHO ** (1 - nodes) / (_RHO - 1)))


def over_alpha(lower: float, upper: float, nodes: int) -> float:
    """Bound the error of interpolation of R in α from `lower` > 0 to `upper`."""
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    room = middle**2 - (half * _REAL) ** 2
    tangent2 = np.where(room > 0, (half * _IMAGINARY) ** 2 / np.maximum(room, 1e-300), np.inf)
    return _interpolation((1 + tangent2) ** 1.25, nodes)


def complex_fibre(alpha: float, imaginary: np.ndarray) -> np.ndarray:
    """Bound |1 − P_s| (…) for fibres whose directions have imaginary parts of lengths (…)."""
    q = (1 - alpha**2) * (imaginary / alpha) ** 2
    return np.where(q < 1, np.maximum(1 - q, 1e-300) ** -2.5, np.inf)


def over_theta(alpha: float, half: float, nodes: int) -> float:
    """Bound the error of interpolation of R in θf on an interval of length 2 `half`, from α on."""
    with np.errstate(over="ignore"):
        return _interpolation(complex_fibre(alpha, np.sinh(half * _IMAGINARY)), nodes)


def azimuths(alpha: float, sin_theta_f: float, tolerance: float) -> tuple[int, float]:
    """Return a number of midpoints in φ on [0, π], and the error that they leave, ≤ `tolerance`.

    The number is a multiple of eight.
    """
    strip = np.arcsinh(np.geomspace(0.02, 0.999, 96) * alpha / max(sin_theta_f, 1e-3))
    bound = 2 * complex_fibre(alpha, min(sin_theta_f, 1.0) * np.sinh(strip))

    def left(count: int) -> float:
        return SAFETY * float(np.min(bound / np.expm1(np.minimum(2 * count * strip, 600))))

    count = 8
    while left(count) > tolerance:
        count += 8
    return count, left(count)


@functools.cache
def rule() -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss–Legendre nodes and weights in float64, and how much they err on each Tₖ.

    The first array is (2, NODES). The second has |∫Tₖ − Σ wᵢ Tₖ(xᵢ)| for k < 2 NODES, computed in
    exact fractions. It makes no difference how the nodes were found.
    """
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    nodes, weights = (nodes - nodes[::-1]) / 2, (weights + weights[::-1]) / 2
    exact = [
        (Fraction(x), Fraction(w)) for x, w in zip(nodes.tolist(), weights.tolist(), strict=True)
    ]
    last, this = [Fraction(1)] * NODES, [x for x, _ in exact]
    errors = []
    for k in range(2 * NODES):
        found = sum(w * t for (_, w), t in zip(exact, last, strict=True))
        integral = 0 if k % 2 else Fraction(2, 1 - k * k)
        errors.append(float(abs(found - integral)))
        last, this = this, [2 * x * b - a for (x, _), a, b in zip(exact, last, this, strict=True)]
    return np.stack([nodes, weights]), np.array(errors)


def imaginary_parts(
    first: np.ndarray, last: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Bound the lengths of the imaginary parts of h and of u, for z = x + iy with cos θu = sin²z.

    x is between `first` and `last`, and y at most the given one, arrays of one shape. The bounds
    are infinite where the real part of sin²z might not be positive.
    """
    fine = (first > 0) & (last < np.pi) & (y < 1)
    first, last = np.where(fine, first, 1.0), np.where(fine, last, 1.0)
    y = np.where(fine, y, 0.0)
    # notation: s = sin x, S = sinh y, c = sin²z with a real part of at least c_0, 2 turn ≥ |Im θu|
    sine, cosine = np.sinh(y), np.cosh(y)
    s_min, s_max = _sines(first, last)
    cos_max = np.maximum(np.abs(np.cos(first)), np.abs(np.cos(last)))
    twice = np.maximum(np.abs(np.sin(2 * first)), np.abs(np.sin(2 * last)))
    around = ((first < np.pi / 4) & (last > np.pi / 4)) | (last > 3 * np.pi / 4)
    twice = np.where(around, 1.0, twice)
    c_0 = np.minimum(s_min**2, s_min**2 * (1 + 2 * sine**2) - sine**2)
    fine &= (c_0 > 0) & (sine * cosine < 2)
    c_0 = np.where(fine, c_0, 1.0)
    under = np.where(fine, 1 + 2 * sine**2 - (sine / s_min) ** 2, 1.0)
    along_m = sine * cosine * cos_max / np.sqrt(under) / (1 + c_0) ** 1.5
    along_k = sine * cosine * twice / 2 / (1 + c_0) ** 1.5
    c_max = s_max**2 + sine**2
    turn = y * np.sqrt(c_max / np.sqrt(1 + 2 * c_0 + c_max**2))
    of_h = np.hypot(np.cosh(turn) * along_m, along_k) + np.sinh(turn)
    return np.where(fine, of_h, np.inf), np.where(fine, np.sinh(2 * turn), np.inf)


def _sines(first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and a largest value of sin x between two numbers in [0, π]."""
    ends = np.sin(first), np.sin(last)
    return np.minimum(*ends), np.where(last < np.pi / 2, ends[1], 1.0)


def complex_light(alpha: float, first: np.ndarray, last: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Bound |1 − P_s| for the lights of `imaginary_parts`, for any fibre."""
    ratio = (1 - alpha**2) / alpha**2
    parts = imaginary_parts(first, last, y)
    fine = np.isfinite(parts[0])
    q_h, q_u = (ratio * np.where(fine, each, 0.0) ** 2 for each in parts)
    fine &= (q_h < 1) & (q_u < 1)
    q_h, q_u = np.where(fine, q_h, 0.0), np.where(fine, q_u, 0.0)
    return np.where(fine, (1 - q_h) ** -2 * (1 - q_u) ** -0.5 / alpha**2, np.inf)


def panel_error(alpha: float, lower: float, upper: float) -> float:
    """Bound what the rule leaves out of one panel in z, for any fibre.

    The integrand is 4 sin³z cos z times the average of 1 − P_s over φ, with cos θu = sin²z. Its
    bound holds in a rectangle that contains the ellipse.
    """
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    first, last, y = middle - half * _REAL, middle + half * _REAL, half * _IMAGINARY
    bound = complex_light(alpha, first, last, y)
    fine = np.isfinite(bound)
    first, last, y = (np.where(fine, each, 1.0) for each in (first, last, y))
    # |sin z|² = sin²x + sinh²y and |cos z|² = cos²x + sinh²y
    sine2 = _sines(first, last)[1] ** 2 + np.sinh(y) ** 2
    cosine2 = np.maximum(np.cos(first) ** 2, np.cos(last) ** 2) + np.sinh(y) ** 2
    _, defects = rule()
    left = 64 / 15 * _RHO ** (-2.0 * NODES) / (1 - _RHO**-2) + 2 * _POWERS @ defects
    return SAFETY * float(np.min(half * bound * 4 * sine2**1.5 * np.sqrt(cosine2) * left))


@dataclass(frozen=True)
class Panels:
    """The lower ends of the panels in z, and a bound of what the rules on them leave out.

    The last panel ends at π/2. Below the first panel, the integral is between 0 and its end⁴.
    """

    ends: np.ndarray
    error: float


@functools.cache
def panels(alpha: float, tolerance: float) -> Panels:
    """Divide [0, π/2] so that the rules leave out at most `tolerance`, for all fibres at this α."""
    share, least = tolerance / 50, (tolerance / 4) ** 0.25
    while True:
        ends, error = [np.pi / 2], 0.0
        while ends[-1] > least:
            # The panel may not be longer than what lies below its upper end.
            short, long = 0.0, ends[-1]
            for _ in range(_HALVINGS):
                width = (short + long) / 2
                good = panel_error(alpha, ends[-1] - width, ends[-1]) <= share
                short, long = (width, long) if good else (short, width)
            error += panel_error(alpha, ends[-1] - short, ends[-1])
            ends.append(ends[-1] - short)
        error += ends[-1] ** 4
        if error <= tolerance:
            return Panels(np.array(ends[:0:-1]), error)
        share /= 2
