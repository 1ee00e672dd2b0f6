"""The best single lobe of many: that of the least Kullback–Leibler divergence.

In the plane of slopes, the density of a lobe is 1/(π √|Â| (1 + q)²) with q = (s − μ)ᵀÂ⁻¹(s − μ): a
t-distribution. For slopes s with weights p, the best μ and Â are the fixed point of

    w = p/(1 + q),  μ ← Σ w s/Σ w,  Â ← 2 Σ w (s − μ)(s − μ)ᵀ/Σ w.

This is expectation maximisation in the form of Kent, Tyler and Vardi (1994), which converges
faster than that with Σ p/2 in place of the last Σ w.
"""

import numpy as np

STEPS = 8
# An ellipse of slopes whose area is this part of the squared radius is rounded to a line.
_LEAST = 1e-14
_GOLDEN = (np.sqrt(5) - 1) / 2


def unit_slopes(lobes: int, radii: int, angles: int) -> np.ndarray:
    """Return slopes (lobes, radii · angles, 2) of GGX of width 1, of equal weight.

    All lobes together have lobes · radii rings, whose radii are the middles of equal shares of the
    facets. Each lobe has `radii` of them, of which none is near another. For equal lobes, the
    fixed point is exact, for at least 3 angles: q/(1 + q) of a ring is its quantile, and the
    quantiles have the mean ½.
    """
    order = np.random.default_rng(0).permutation(lobes)
    quantile = (np.arange(radii) + (order[:, None] + 0.5) / lobes) / radii
    ring = np.arange(lobes * radii).reshape(lobes, radii, 1)
    turn = (np.arange(angles) + _GOLDEN * ring) * 2 * np.pi / angles
    radius = np.sqrt(quantile / (1 - quantile))[..., None]
    slopes = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1)
    return slopes.reshape(lobes, radii * angles, 2)


def slopes_of_lobes(mean: np.ndarray, spread: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Return slopes (…, lobes · samples, 2) of lobes.

    `mean` (…, lobes, 2) and `spread` (…, lobes, 3) are μ and Â of each lobe.
    `unit` (samples, 2) or (lobes, samples, 2) are slopes of lobes of width 1.
    """
    xx, xy, yy = (spread[..., k, None] for k in range(3))
    first = np.sqrt(xx)
    below = xy / first
    second = np.sqrt(np.maximum(yy - below * below, 0))
    u, v = unit[..., 0], unit[..., 1]
    x, y = mean[..., 0, None] + first * u, mean[..., 1, None] + below * u + second * v
    flat = (*x.shape[:-2], -1)
    return np.stack([x.reshape(flat), y.reshape(flat)], axis=-1)


def best_lobe(
    slopes: np.ndarray,
    weights: np.ndarray,
    mean: np.ndarray,
    spread: np.ndarray,
    steps: int = STEPS,
) -> tuple[np.ndarray, np.ndarray]:
    """Return μ (…, 2) and Â (…, 3) of the best lobe for slopes (…, n, 2) with weights (…, n).

    `mean` and `spread` are the lobe from which the fixed point is iterated `steps` times.
    """
    x, y = slopes[..., 0], slopes[..., 1]
    for _ in range(steps):
        xx, xy, yy = (spread[..., k, None] for k in range(3))
        determinant = np.maximum(xx * yy - xy * xy, _LEAST * (xx + yy) ** 2)
        dx, dy = x - mean[..., 0, None], y - mean[..., 1, None]
        q = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / determinant
        w = weights / (1 + q)
        total = np.sum(w, axis=-1)
        shift = np.stack([np.sum(w * dx, -1) / total, np.sum(w * dy, -1) / total], axis=-1)
        wx = w * dx
        second = np.stack([np.sum(wx * dx, -1), np.sum(wx * dy, -1), np.sum(w * dy * dy, -1)], -1)
        second = second / total[..., None]
        moved = np.stack(
            [shift[..., 0] ** 2, shift[..., 0] * shift[..., 1], shift[..., 1] ** 2], axis=-1
        )
        spread = 2 * (second - moved)
        mean = mean + shift
    return mean, spread
