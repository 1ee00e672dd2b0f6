"""What a footprint of lobes is in truth: the mean of their slope densities and of their radiance.

The slope density of an average over area counts each texel as often as D(h) cos θ does, where θ is
measured from the plane of the map: by √S₃₃ of its SGGX matrix.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from shadefit.maps.best_lobe import unit_slopes
from shadefit.maps.lobes import (
    lobe_matrices,
    lobes_of_matrices,
    matrices_of_slopes,
    slope_moments,
)

# Radii and angles of the grid of slopes on which densities are compared.
GRID = (128, 128)
# Lobes whose densities are computed at once.
_LOBES = 64


@dataclass(frozen=True)
class SlopeGrid:
    """A grid of slopes (points, 2) over a footprint, its cells, and the true density there."""

    slopes: np.ndarray
    cells: np.ndarray
    density: np.ndarray

    @property
    def total(self) -> float:
        """The integral of the true density by the grid: 1, but for the grid's own error."""
        return float(np.sum(self.cells * self.density))


def slope_density(slopes: np.ndarray, mean: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Return 1/(π √|Â| (1 + q)²) at slopes (points, 2), of lobes (…, 2) and (…, 3)."""
    xx, xy, yy = (spread[..., k, None] for k in range(3))
    determinant = xx * yy - xy * xy
    x, y = slopes[:, 0] - mean[..., 0, None], slopes[:, 1] - mean[..., 1, None]
    q = (yy * x * x - 2 * xy * x * y + xx * y * y) / determinant
    return 1 / (np.pi * np.sqrt(determinant) * (1 + q) ** 2)


def footprint_grid(
    normals: np.ndarray, roughness: np.ndarray, grid: tuple[int, int] = GRID
) -> SlopeGrid:
    """Return the true density of slopes of lobes (lobes, 3) and (lobes, 3).

    The grid has equal shares of the lobe with the mean Â and twice the covariance of slopes, which
    is wide enough for the footprint.
    """
    matrices = lobe_matrices(normals, roughness)
    mean, spread = slope_moments(matrices)
    weights = np.sqrt(matrices[:, 5])
    weights = weights / np.sum(weights)
    middle = np.mean(mean, axis=0)
    x, y = (mean - middle).T
    cover = np.mean(spread, axis=0) + 2 * np.mean([x * x, x * y, y * y], axis=1)
    first = np.sqrt(cover[0])
    root = np.array([[first, 0], [cover[1] / first, np.sqrt(cover[2] - (cover[1] / first) ** 2)]])
    slopes = middle + unit_slopes(1, *grid)[0] @ root.T
    cells = 1 / (len(slopes) * slope_density(slopes, middle, cover))
    density = np.zeros(len(slopes))
    for start in range(0, len(mean), _LOBES):
        part = slice(start, start + _LOBES)
        density += weights[part] @ slope_density(slopes, mean[part], spread[part])
    return SlopeGrid(slopes, cells, density)


def total_variation(grid: SlopeGrid, normal: np.ndarray, roughness: np.ndarray) -> float:
    """Return ½ ∫ |p − q| over slopes for the true density p and that of one lobe (3,) and (3,)."""
    mean, spread = slope_moments(lobe_matrices(normal, roughness))
    density = slope_density(grid.slopes, mean, spread)
    return float(np.sum(grid.cells * np.abs(grid.density - density)) / 2)


def best_lobe_by_descent(grid: SlopeGrid, mean, spread) -> tuple[np.ndarray, np.ndarray]:
    """Return the normal and the roughness of the lobe of least divergence, by BFGS on the grid.

    It does not use the fixed point of `shadefit.maps.best_lobe`, and judges it. `mean` (2,) and
    `spread` (xx, xy, yy) are those of the slopes of the lobe where the descent begins.
    """

    def lobe(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first, second = np.exp(x[2]), np.exp(x[3])
        return x[:2], np.array([first * first, first * x[4], x[4] ** 2 + second * second])

    def cross_entropy(x: np.ndarray) -> float:
        return -float(
            np.sum(grid.cells * grid.density * np.log(slope_density(grid.slopes, *lobe(x))))
        )

    first = np.sqrt(spread[0])
    below = spread[1] / first
    start = [*mean, np.log(first), np.log(np.sqrt(spread[2] - below * below)), below]
    found = minimize(cross_entropy, start, method="BFGS", options={"gtol": 1e-6})
    return lobes_of_matrices(matrices_of_slopes(*lobe(found.x)))


def lit_plane(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit vectors to the eye and to the light (points², 3) of a lit plane.

    The plane is [−2, 2]², the eye is at (0, −2, 1.5) and the light at (0, 2, 1.5).
    """
    middles = (np.arange(points) + 0.5) * 4 / points - 2
    place = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    place = np.concatenate([place, np.zeros((len(place), 1))], axis=-1)
    to = [np.array(end) - place for end in ((0, -2, 1.5), (0, 2, 1.5))]
    eye, light = (each / np.linalg.norm(each, axis=-1, keepdims=True) for each in to)
    return eye, light


def radiance(
    normals: np.ndarray, roughness: np.ndarray, view: np.ndarray, light: np.ndarray
) -> np.ndarray:
    """Return the radiance D G2/(4 n·v) of lobes (…, 3) without Fresnel, lit by irradiance 1.

    `view` and `light` (points, 3) are unit vectors in the frame of the map. The result is
    (…, points). It is 0 where a direction is below the plane of the lobe's normal.
    """
    matrices = lobe_matrices(normals, roughness)
    determinant = (roughness[..., 0] * roughness[..., 2] - roughness[..., 1] ** 2)[..., None]
    half = view + light
    half = half / np.linalg.norm(half, axis=-1, keepdims=True)
    cos_view, cos_light = (normals @ each.T for each in (view, light))
    area_view, area_light = (np.sqrt(_form(matrices, each)) for each in (view, light))
    inverse = _form(_adjugate(matrices), half) / determinant
    ndf = 1 / (np.pi * np.sqrt(determinant) * inverse**2)
    lit = (cos_view > 0) & (cos_light > 0)
    below = np.where(lit, 2 * (cos_light * area_view + cos_view * area_light), 1)
    return np.where(lit, ndf * cos_light / below, 0)


def _form(matrices: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Return wᵀSw of matrices (…, 6) and directions (points, 3): (…, points)."""
    x, y, z = direction.T
    products = np.stack([x * x, 2 * x * y, 2 * x * z, y * y, 2 * y * z, z * z])
    return matrices @ products


def _adjugate(matrices: np.ndarray) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (matrices[..., k] for k in range(6))
    return np.stack(
        [
            yy * zz - yz * yz,
            xz * yz - xy * zz,
            xy * yz - xz * yy,
            xx * zz - xz * xz,
            xy * xz - xx * yz,
            xx * yy - xy * xy,
        ],
        axis=-1,
    )
