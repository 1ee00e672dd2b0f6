"""Profiles for the tests of the piecewise-linear NDF, and quadrature that shares no formula."""

import itertools

import mpmath as mp
import numpy as np

from shading.piecewise import slopes
from shading.piecewise.blend import Blend
from shading.piecewise.moments import normalised
from shading.piecewise.ndf import Profile, profile, uniform_knots


def random_profile(seed: int, segments: int = 6, variable: str = "angle") -> Profile:
    """Return a normalised profile with random knots and values, which is not monotone."""
    rng = np.random.default_rng(seed)
    inside = (np.arange(1, segments) + rng.uniform(-0.4, 0.4, segments - 1)) * 1.5 / segments
    values = rng.uniform(0.1, 1, segments + 1)
    return normalised(profile([0, *inside, np.pi / 2], values, variable))


def random_blend(seed: int, segments: int = 6, variable: str = "angle") -> Blend:
    """Return a blend of two random profiles with the same knots."""
    x = random_profile(seed, segments, variable)
    y = np.random.default_rng(seed + 100).uniform(0.1, 1, segments + 1)
    return Blend(x, normalised(Profile(x.knots, y, variable)))


def sampled(kind: str, width: float, segments: int, variable: str = "angle") -> Profile:
    """Return Beckmann's or GGX's NDF at uniform knots, not normalised."""
    knots = uniform_knots(segments)
    if kind == "ggx":
        return profile(knots, slopes.student_t(knots, width, 2.0), variable)
    return profile(knots, slopes.beckmann(knots, width), variable)


def gauss(breaks, nodes: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss points and weights between increasing breaks."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    left, right = np.asarray(breaks[:-1], float)[:, None], np.asarray(breaks[1:], float)[:, None]
    half = (right - left) / 2
    return (left + half * (x + 1)).ravel(), (half * w).ravel()


def values_of(ndf: Profile, theta: np.ndarray) -> np.ndarray:
    """Return D(θ) by NumPy's own interpolation."""
    knots, values = np.asarray(ndf.knots), np.asarray(ndf.values)
    if ndf.variable == "angle":
        return np.interp(theta, knots, values)
    return np.interp(np.sin(theta) ** 2, np.sin(knots) ** 2, values)


def blend_values(ndf: Blend, theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return D(θ, φ) as Eq. 1 says."""
    x0, y0 = float(ndf.x.values[0]), float(ndf.y.values[0])
    x, y = values_of(ndf.x, theta), values_of(ndf.y, theta)
    return (np.cos(phi) ** 2 * x * y0 + np.sin(phi) ** 2 * y * x0) / ((x0 + y0) / 2)


def area_by_definition(ndf: Blend, theta_o: float, phi_o: float, part: str) -> float:
    """Return an integral of (o·m) D over a part of the hemisphere of normals, by the product rule.

    `part` is "front" (I₁), "back" (I₂¹), "rim" (I₂²), or "hidden" (where o·m < 0, with the sign of
    −o·m).
    """
    knots, edge = np.asarray(ndf.x.knots), np.pi / 2 - theta_o
    low, high = {"front": (0, np.pi / 2), "back": (0, edge)}.get(part, (edge, np.pi / 2))
    breaks = [low, *knots[(knots > low) & (knots < high)], high]
    if part in ("front", "back"):
        theta, w_theta = gauss(breaks)
    else:
        y, w = gauss(np.sqrt(np.maximum(np.asarray(breaks) - edge, 0)))
        theta, w_theta = edge + y * y, 2 * y * w
    limit = np.arccos(np.clip(-1 / (np.tan(theta_o) * np.tan(theta)), -1, 1))
    ranges = {
        "front": [(-np.pi / 2 + 0 * theta, np.pi / 2 + 0 * theta)],
        "back": [(np.pi / 2 + 0 * theta, 3 * np.pi / 2 + 0 * theta)],
        "rim": [(np.pi / 2 + 0 * theta, limit), (2 * np.pi - limit, 3 * np.pi / 2 + 0 * theta)],
        "hidden": [(limit, 2 * np.pi - limit)],
    }[part]
    x, w_phi = gauss([0, 1], 48)
    total = 0.0
    for start, end in ranges:
        turn = start[:, None] + (end - start)[:, None] * x
        at = theta[:, None]
        projected = np.sin(theta_o) * np.sin(at) * np.cos(turn) + np.cos(theta_o) * np.cos(at)
        values = projected * blend_values(ndf, at, turn + phi_o) * np.sin(at)
        total += np.sum(w_theta * ((values @ w_phi) * (end - start)))
    return float(-total if part == "hidden" else total)


def exact_hidden_area(ndf: Profile, theta_o: float) -> mp.mpf:
    """Return H of an isotropic profile with 30 digits."""
    with mp.workdps(30):
        knots = [mp.mpf(float(each)) for each in ndf.knots[:-1]] + [mp.pi / 2]
        values = [mp.mpf(float(each)) for each in ndf.values]
        theta = mp.mpf(float(theta_o))
        edge, sine, cosine = mp.pi / 2 - theta, mp.sin(theta), mp.cos(theta)

        def integrand(at, k):
            if ndf.variable == "angle":
                part = (at - knots[k]) / (knots[k + 1] - knots[k])
            else:
                low, high = mp.sin(knots[k]) ** 2, mp.sin(knots[k + 1]) ** 2
                part = (mp.sin(at) ** 2 - low) / (high - low)
            density = values[k] + (values[k + 1] - values[k]) * part
            opened = mp.acos(min(mp.mpf(1), mp.cot(theta) * mp.cot(at)))
            area = sine * mp.sin(at) * mp.sin(opened) - cosine * mp.cos(at) * opened
            return 2 * density * mp.sin(at) * area

        total = mp.mpf(0)
        for k, (left, right) in enumerate(itertools.pairwise(knots)):
            if right <= edge:
                continue
            low, high = mp.sqrt(max(left - edge, 0)), mp.sqrt(right - edge)
            cuts = [low + (high - low) * part for part in (0, mp.mpf(1) / 8, mp.mpf(1) / 2, 1)]
            total += mp.quad(lambda y, k=k: integrand(edge + y * y, k) * 2 * y, cuts)
        return total
