"""R as polynomials on patches of (α, θf), with a proven bound of their difference from R.

On each patch, R is interpolated at Chebyshev nodes. Its values at the nodes are sums in interval
arithmetic (`kernel/average.h`). docs/r-theorem.md says why each part of the bound holds.
"""

import ctypes
import functools
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np

from fitting.proofs.largest_error import printed
from programs.bounding.compiled import Kernel, compile_kernel
from quantities.fuzz import ps_error, r_bounds
from quantities.fuzz.ps_error import KERNEL

# Nodes of each patch in α and θf
BY_ALPHA, BY_THETA = 10, 14
# The part of the tolerance for the interpolation in each variable; the rest is for the values.
_SHARE = 0.3
# A patch is wider than its part of the domain, so that each small box is on one patch.
_OVERLAP = 1.04
# The ends of the domain are on the patch in spite of rounding.
_WIDER = 1 + 1e-9
_HALF_PI = pi / 2
_COMPLEMENT = ("c", "sigma2", "r", "m", "lam", "gap")
# Float64 evaluates a polynomial of these degrees, and its nodes, within so many units of rounding
# of the sum of the coefficients' magnitudes.
_ROUNDING = 400 * np.finfo(float).eps


@dataclass(frozen=True)
class Patches:
    """Polynomials in α and θf that differ from R by at most `error`.

    * `slab_ends`: the upper ends of the slabs in α; `slab_first`: the first patch of each, and the
      number of all.
    * `places` (patches, 4): middle and half width in α, then in θf.
    * `powers` (patches, BY_ALPHA, BY_THETA): coefficients of (α − middle)/half and the same of θf.
    """

    slab_ends: tuple[float, ...]
    slab_first: tuple[int, ...]
    places: np.ndarray
    powers: np.ndarray
    error: float


def _node(place: np.ndarray, number: int, count: int) -> np.ndarray:
    return np.array([*place, number, count], dtype=float)


@functools.cache
def _averages() -> Kernel:
    parts = (
        printed("sizes", ps_error.SIZES, ps_error.sizes, 2),
        printed("factors", (*ps_error.SIZES, "sigma2", "q"), ps_error.factors, 3),
        printed("complement", _COMPLEMENT, ps_error.complement),
        (KERNEL / "cubic_root.h").read_text("utf-8"),
        (KERNEL / "average.h").read_text("utf-8"),
    )
    return compile_kernel(parts, 0, fast=True)


def average(alpha: np.ndarray, theta: np.ndarray, tolerance: float) -> tuple[float, float]:
    """Return a lower and an upper bound of R at a Chebyshev node, about 2 `tolerance` apart.

    Arguments: `alpha` and `theta` hold the middle and half the width of an interval, and the number
    and the count of the node. A half width of zero stands for the middle itself.
    """
    at, sine = (
        float(x[0] + x[1] * np.cos((2 * x[2] + 1) * _HALF_PI / x[3])) for x in (alpha, theta)
    )
    panels = r_bounds.panels(at, tolerance / 2)
    # The sine is rounded, and 1e-9 more than that makes up for it.
    azimuths, left = r_bounds.azimuths(at, abs(np.sin(sine)) + 1e-9, tolerance / 2)
    rule, _ = r_bounds.rule()
    bounds = np.empty(2)
    arrays = [np.ascontiguousarray(x) for x in (alpha, theta, panels.ends, rule, bounds)]
    first, second, ends, nodes, result = (
        x.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for x in arrays
    )
    _averages().library.shadefit_average(
        first,
        second,
        ends,
        ctypes.c_long(len(panels.ends)),
        nodes,
        ctypes.c_long(r_bounds.NODES),
        ctypes.c_long(azimuths),
        result,
    )
    low, high = arrays[-1].tolist()
    error = panels.error + left * r_bounds.SAFETY
    return 1 - high - error, 1 - low + error


@dataclass(frozen=True)
class _Slab:
    """A slab in α, on which all patches have the same width in θf."""

    alpha: np.ndarray
    count: int
    error: float


def _slabs(lower: float, upper: float, tolerance: float) -> tuple[list[float], list[_Slab]]:
    """Divide the domain so that interpolation errs by at most `tolerance` in each variable."""
    ends, slabs = [lower], []
    allowed = tolerance / r_bounds.lebesgue(BY_ALPHA)
    while ends[-1] < upper:
        far = upper
        while r_bounds.over_alpha(*_widened(ends[-1], far, lower, upper), BY_ALPHA) > tolerance:
            far = ends[-1] + 0.95 * (far - ends[-1])
        low, high = _widened(ends[-1], far, lower, upper)
        by_alpha, count = r_bounds.over_alpha(low, high, BY_ALPHA), 1
        while r_bounds.over_theta(low, _half(count), BY_THETA) > allowed:
            count += 1
        by_theta = r_bounds.over_theta(low, _half(count), BY_THETA)
        error = by_alpha + r_bounds.lebesgue(BY_ALPHA) * by_theta
        place = np.array([(low + high) / 2, (high - low) / 2 * _WIDER])
        slabs.append(_Slab(place, count, error))
        ends.append(far)
    return ends, slabs


def _widened(low: float, high: float, lower: float, upper: float) -> tuple[float, float]:
    more = (_OVERLAP - 1) / 2 * (high - low)
    return max(low - more, lower), min(high + more, upper)


def _half(count: int) -> float:
    return _OVERLAP * _HALF_PI / (2 * count)


def _interpolant(values: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the powers of a polynomial, and its largest distance from the bounds of the values.

    `values` (BY_ALPHA, BY_THETA, 2) has bounds of the values at the nodes.
    """
    nodes = [np.cos((2 * np.arange(n) + 1) * _HALF_PI / n) for n in (BY_ALPHA, BY_THETA)]
    middle = values.mean(axis=2)
    bases = [np.polynomial.chebyshev.chebvander(x, len(x) - 1) for x in nodes]
    sums = np.linalg.solve(bases[0], np.linalg.solve(bases[1], middle.T).T)
    to_powers = [
        np.stack(
            [
                np.pad(p := np.polynomial.chebyshev.cheb2poly(row), (0, len(row) - len(p)))
                for row in np.eye(len(x))
            ]
        )
        for x in nodes
    ]
    powers = to_powers[0].T @ sums @ to_powers[1]
    found = np.polynomial.polynomial.polygrid2d(*nodes, powers)
    far = np.maximum(np.abs(found - values[..., 0]), np.abs(found - values[..., 1]))
    return powers, float(far.max() + _ROUNDING * np.abs(powers).sum())


@functools.lru_cache(maxsize=4)
def patches(lower: float, upper: float, tolerance: float, threads: int = 2) -> Patches:
    """Interpolate R for α from `lower` > 0 to `upper` ≤ 1 and all θf, within about `tolerance`.

    The work grows as lower⁻³. Raises ToolchainError without a C compiler.
    """
    ends, slabs = _slabs(lower, upper, _SHARE * tolerance)
    factor = r_bounds.lebesgue(BY_ALPHA) * r_bounds.lebesgue(BY_THETA)
    within = (1 - 2 * _SHARE) * tolerance / factor / 2
    places, jobs = [], []
    for slab in slabs:
        for k in range(slab.count):
            # The outer patches are not wider at the ends of the domain.
            low = max((k + 0.5) / slab.count * _HALF_PI - _half(slab.count), 0.0)
            high = min((k + 0.5) / slab.count * _HALF_PI + _half(slab.count), _HALF_PI)
            theta = np.array([(low + high) / 2, (high - low) / 2 * _WIDER])
            places.append((*slab.alpha, *theta))
            jobs += [
                (_node(slab.alpha, i, BY_ALPHA), _node(theta, j, BY_THETA), within)
                for i in range(BY_ALPHA)
                for j in range(BY_THETA)
            ]
    _averages()
    with ThreadPoolExecutor(threads) as pool:
        values = np.array(list(pool.map(lambda job: average(*job), jobs)))
    found = [_interpolant(each) for each in values.reshape(-1, BY_ALPHA, BY_THETA, 2)]
    counts = np.cumsum([0, *(slab.count for slab in slabs)])
    error = max(
        slab.error + factor * max(distance for _, distance in found[first:last])
        for slab, (first, last) in zip(slabs, pairwise(counts), strict=True)
    )
    return Patches(
        tuple(ends[1:]),
        tuple(counts.tolist()),
        np.array(places),
        np.array([powers for powers, _ in found]),
        error * r_bounds.SAFETY,
    )
