"""Errors of the encodings of anisotropic roughness: random texels, and an adversarial search.

An error is the total variation between the distribution that is encoded and the one that a shader
decodes. Widths are from 0.03 to 1.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from shadefit.maps.aniso_map import decoded
from shading.maps.encode import encode, entries_of_widths, widths_of_entries
from shading.maps.total_variation import total_variation

LEAST_WIDTH = 0.03

# Rows of ln αt, ln αb and θ
Points = Float[np.ndarray, "points 3"]


@dataclass(frozen=True)
class Errors:
    """The mean, the 99th percentile and the largest of total variations.

    `elongated` is the 99th percentile of texels with αt > 8 αb.
    """

    mean: float
    percentile: float
    largest: float
    elongated: float


@dataclass(frozen=True)
class Worst:
    """The largest error that a search found, and the widths and the angle (rad) where it is."""

    error: float
    alpha_t: float
    alpha_b: float
    theta: float


def random_points(count: int, seed: int = 1) -> Points:
    """Return widths αt ≥ αb, whose logarithms are uniform, and angles of the tangent."""
    rng = np.random.default_rng(seed)
    logs = rng.uniform(np.log(LEAST_WIDTH), 0.0, (count, 2))
    angles = rng.uniform(-np.pi / 2, np.pi / 2, count)
    return np.column_stack([logs.max(axis=1), logs.min(axis=1), angles])


def errors_at(encoding: str, points: Points, bits: int) -> Float[np.ndarray, "points"]:
    """Return the total variations at points, for channels of so many bits."""
    alpha_t, alpha_b, theta = np.exp(points[:, 0]), np.exp(points[:, 1]), points[:, 2]
    largest = 2**bits - 1
    alpha_t, alpha_b = np.minimum(alpha_t, 1.0), np.minimum(alpha_b, 1.0)
    codes = np.rint(encode(encoding, alpha_t, alpha_b, theta) * largest)
    found = decoded(encoding, codes / largest)[:, :3]
    return total_variation(entries_of_widths(alpha_t, alpha_b, theta), found)


def errors_of(encoding: str, points: Points, bits: int) -> Errors:
    """Return the statistics of the total variations at points."""
    found = errors_at(encoding, points, bits)
    elongated = points[:, 0] - points[:, 1] > np.log(8)
    return Errors(
        float(found.mean()),
        float(np.quantile(found, 0.99)),
        float(found.max()),
        float(np.quantile(found[elongated], 0.99)),
    )


def worst_texel(
    encoding: str, bits: int, *, starts: int = 400, rounds: int = 60, seed: int = 2
) -> Worst:
    """Search for the largest error by local search, with starts of two kinds.

    Half of the starts are the worst of 50 times as many random texels, and half are at the ends of
    the domain, where αt is 1 or αb is 0.03. In each round every start tries 16 steps, whose length
    shrinks from a tenth of the domain to less than a tenth of a code, and takes the best.
    """
    rng = np.random.default_rng(seed)
    low, high = np.log(LEAST_WIDTH), 0.0
    many = random_points(50 * starts, seed)
    best = many[np.argsort(errors_at(encoding, many, bits))[-starts:]]
    ends = random_points(starts, seed + 1)
    ends[::2, 0], ends[1::2, 1] = high, low
    at = np.concatenate([best, ends])
    value = errors_at(encoding, at, bits)
    for radius in np.geomspace(0.1, 1e-4, rounds):
        steps = (
            rng.normal(size=(16, *at.shape)) * radius * np.array([high - low, high - low, np.pi])
        )
        tried = at + steps
        logs = np.sort(np.clip(tried[..., :2], low, high), axis=-1)
        tried = np.concatenate([logs[..., ::-1], tried[..., 2:]], axis=-1)
        errors = errors_at(encoding, tried.reshape(-1, 3), bits).reshape(16, -1)
        winner, column = errors.argmax(axis=0), np.arange(len(at))
        better = errors[winner, column] > value
        at = np.where(better[:, None], tried[winner, column], at)
        value = np.where(better, errors[winner, column], value)
    k = int(np.argmax(value))
    angle = (at[k, 2] + np.pi / 2) % np.pi - np.pi / 2
    return Worst(float(value[k]), float(np.exp(at[k, 0])), float(np.exp(at[k, 1])), float(angle))


def least_eigenvalue_between(count: int, stores_sxy: bool, seed: int = 3) -> tuple[float, float]:
    """Return the least eigenvalue of filtered texels, and the fraction with a negative one.

    Two random texels are mixed linearly in their channels (√Sxx, y, √Syy). y stands for
    the correlation, as published, or for Sxy itself, and nothing is clamped.
    """
    first, second = (_matrices(random_points(count, seed + k)) for k in (0, 1))
    channels = []
    for entries in (first, second):
        x, z = np.sqrt(entries[:, 0]), np.sqrt(entries[:, 2])
        y = entries[:, 1] if stores_sxy else entries[:, 1] / (x * z)
        channels.append(np.column_stack([x, y, z]))
    share = np.random.default_rng(seed).random((count, 1))
    x, y, z = ((1 - share) * channels[0] + share * channels[1]).T
    sxy = y if stores_sxy else x * y * z
    half = np.hypot((x * x - z * z) / 2, sxy)
    least = (x * x + z * z) / 2 - half
    return float(least.min()), float(np.mean(least < -1e-12))


def _matrices(points: Points) -> Float[np.ndarray, "points 3"]:
    return entries_of_widths(np.exp(points[:, 0]), np.exp(points[:, 1]), points[:, 2])


def mixed_error(encoding: str, first: np.ndarray, second: np.ndarray, bits: int = 8) -> float:
    """Return the total variation between a mixture of two lobes and the texel between theirs.

    `first` and `second` are matrices (3,) with the same normal. The texel is the mean of their
    channels, which have so many bits, as a linear filter returns it half-way.
    """
    channels = []
    for entries in (first, second):
        largest = 2**bits - 1
        codes = np.rint(encode(encoding, *widths_of_entries(entries)) * largest)
        channels.append(codes / largest)
    found = decoded(encoding, (channels[0] + channels[1]) / 2)[:3]
    return mixture_distance(first, second, found)


def mixture_distance(first: np.ndarray, second: np.ndarray, single: np.ndarray) -> float:
    """Return the total variation between the mean of two lobes and a single one, by quadrature.

    Each lobe is (Sxx, Sxy, Syy).
    """
    size = 512
    angle = (np.arange(size) + 0.5) * 2 * np.pi / size
    share = (np.arange(size) + 0.5) / size
    radius = np.sqrt(share / (1 - share))[:, None]
    # The nodes have equal masses in the distribution of the mean matrix.
    sxx, sxy, syy = (np.asarray(first) + np.asarray(second)) / 2
    low = np.sqrt(sxx)
    x = low * radius * np.cos(angle)
    y = sxy / low * radius * np.cos(angle)
    y = y + np.sqrt(syy - sxy * sxy / sxx) * radius * np.sin(angle)
    nodes = _density((sxx, sxy, syy), x, y)
    mixture = (_density(first, x, y) + _density(second, x, y)) / 2
    return float(np.mean(np.abs(mixture - _density(single, x, y)) / nodes) / 2)


def _density(entries, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the density of slopes of a lobe."""
    sxx, sxy, syy = entries
    determinant = sxx * syy - sxy * sxy
    square = (syy * x * x - 2 * sxy * x * y + sxx * y * y) / determinant
    return 1 / (np.pi * np.sqrt(determinant) * (1 + square) ** 2)
