"""Filters that average a few numbers of each texel, and make lobes of the averages.

Each filter has `features`, which maps lobes to arrays (…, k) whose means over a footprint are all
that it needs, and `lobes`, which maps such means back to lobes. So it goes from level to level.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from shadefit.maps.lobes import (
    Normals,
    Roughness,
    lobe_matrices,
    lobes_of_matrices,
    matrices_of_slopes,
    slope_moments,
)
from shadefit.maps.tables import widening

# Widths below this are of numerically flat lobes; no division by less.
_LEAST = 1e-12


@dataclass(frozen=True)
class Averaging:
    """A filter by averages: from lobes to features, and from mean features to lobes."""

    features: Callable[[Normals, Roughness], np.ndarray]
    lobes: Callable[[np.ndarray], tuple[Normals, Roughness]]


def _encoded(normals: Normals, roughness: Roughness) -> np.ndarray:
    """Return what a texture holds: the normal, √A_xx, the correlation, and √A_yy."""
    along, across = np.sqrt(roughness[..., 0]), np.sqrt(roughness[..., 2])
    correlation = roughness[..., 1] / (along * across)
    return np.concatenate([normals, np.stack([along, correlation, across], axis=-1)], axis=-1)


def _decoded(means: np.ndarray) -> tuple[Normals, Roughness]:
    normals = means[..., :3] / np.linalg.norm(means[..., :3], axis=-1, keepdims=True)
    along, correlation, across = (means[..., k] for k in (3, 4, 5))
    return normals, np.stack([along**2, along * correlation * across, across**2], axis=-1)


def slope_features(normals: Normals, roughness: Roughness) -> np.ndarray:
    """Return the eight numbers of a texel's slopes: μ (2), μμᵀ (3) and Â (3)."""
    mean, spread = slope_moments(lobe_matrices(normals, roughness))
    x, y = mean[..., :1], mean[..., 1:]
    return np.concatenate([mean, x * x, x * y, y * y, spread], axis=-1)


def split_features(means: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return μ (…, 2), the covariance of slopes (…, 3), and the mean Â (…, 3)."""
    mean = means[..., :2]
    x, y = mean[..., 0], mean[..., 1]
    covariance = means[..., 2:5] - np.stack([x * x, x * y, y * y], axis=-1)
    return mean, covariance, means[..., 5:]


def _lean(means: np.ndarray) -> tuple[Normals, Roughness]:
    mean, covariance, spread = split_features(means)
    return lobes_of_matrices(matrices_of_slopes(mean, spread + 2 * covariance))


def _clean(means: np.ndarray) -> tuple[Normals, Roughness]:
    mean, covariance, spread = split_features(means)
    even = covariance[..., 0] + covariance[..., 2]
    added = np.stack([even, np.zeros_like(even), even], axis=-1)
    return lobes_of_matrices(matrices_of_slopes(mean, spread + added))


def _fitted(means: np.ndarray) -> tuple[Normals, Roughness]:
    mean, covariance, spread = split_features(means)
    return lobes_of_matrices(matrices_of_slopes(mean, widened(spread, covariance)))


def widened(spread: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return Â (…, 3) of the best lobe for lobes Â₀ = `spread` whose centres have a `covariance`.

    It takes the table of `sggx-filter-axes`: with Â₀ = LLᵀ and the eigenvalues tᵢ and eigenvectors
    R of L⁻¹CL⁻ᵀ, it is Â = LR diag((1 + tᵢ) wᵢ) RᵀLᵀ, where wᵢ are the widenings at the shares
    tᵢ/(1 + tᵢ). It is exact to the table's error if the centres are Gaussian and all Â are equal.
    """
    xx, xy, yy = (spread[..., k] for k in range(3))
    first = np.sqrt(np.maximum(xx, _LEAST))
    below = xy / first
    second = np.sqrt(np.maximum(yy - below * below, _LEAST))
    c_xx, c_xy, c_yy = (covariance[..., k] for k in range(3))
    # T = L⁻¹ C L⁻ᵀ with L = [[first, 0], [below, second]]
    t_xx = c_xx / (first * first)
    t_xy = (c_xy / first - below * t_xx) / second
    t_yy = (c_yy - 2 * below * t_xy * second - below * below * t_xx) / (second * second)
    middle, difference = (t_xx + t_yy) / 2, (t_xx - t_yy) / 2
    half = np.hypot(difference, t_xy)
    ends = np.maximum(middle + half, 0), np.maximum(middle - half, 0)
    factors = _widenings(*ends)
    wide, narrow = ((1 + t) * w for t, w in zip(ends, factors, strict=True))
    ratio = (wide - narrow) / np.where(half > 0, 2 * half, 1)
    middle = (wide + narrow) / 2
    g_xx, g_xy, g_yy = middle + ratio * difference, ratio * t_xy, middle - ratio * difference
    # L G Lᵀ
    row = below * g_xx + second * g_xy
    return np.stack(
        [
            first * first * g_xx,
            first * row,
            below * row + second * (below * g_xy + second * g_yy),
        ],
        axis=-1,
    )


def _widenings(along: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the table's widenings for the relative spreads t₁ and t₂."""
    shares = along / (1 + along), across / (1 + across)
    return widening(*shares), widening(*shares[::-1])


AVERAGING: dict[str, Averaging] = {
    "naive": Averaging(_encoded, _decoded),
    "lean": Averaging(slope_features, _lean),
    "clean": Averaging(slope_features, _clean),
    "sggx": Averaging(lobe_matrices, lobes_of_matrices),
    "fitted": Averaging(slope_features, _fitted),
}
