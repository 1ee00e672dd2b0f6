"""Synthetic maps of lobes by seeds: weaves, scratches, bumps, foil, brushed and spun metal.

Each function returns the slopes (height, width, 2) of normals and the roughness (height, width, 3).
Slopes have the sign of the direction: the normal is along (s₁, s₂, 1). The maps are periodic, but
for `spun`.
"""

from collections.abc import Callable

import numpy as np
from scipy.spatial import KDTree

from shadefit.maps.filters import LobeMap
from shading.maps.encode import entries_of_widths

Slopes = np.ndarray


def slopes_to_normals(slopes: Slopes) -> np.ndarray:
    """Return the unit normals (…, 3) along (s₁, s₂, 1)."""
    raised = np.concatenate([slopes, np.ones_like(slopes[..., :1])], axis=-1)
    return raised / np.linalg.norm(raised, axis=-1, keepdims=True)


def _grid(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return x (columns) and y (rows) of the middles of texels, in texels."""
    middles = np.arange(size) + 0.5
    return np.broadcast_to(middles[None, :], (size, size)), np.broadcast_to(
        middles[:, None], (size, size)
    )


def _noise(size: int, rng: np.random.Generator, along: float, across: float) -> np.ndarray:
    """Return periodic Gaussian noise of variance 1, smooth over lengths in texels."""
    frequency = np.fft.fftfreq(size)
    x, y = frequency[None, :] * along, frequency[:, None] * across
    smooth = np.exp(-2 * np.pi**2 * (x * x + y * y))
    field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((size, size))) * smooth).real
    return field / np.std(field)


def _differences(height: np.ndarray) -> Slopes:
    """Return the slopes of normals of a periodic height map, in texels."""
    x = (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) / 2
    y = (np.roll(height, -1, axis=0) - np.roll(height, 1, axis=0)) / 2
    return -np.stack([x, y], axis=-1)


def bumps(size: int, seed: int, *, slope: float, width: float) -> tuple[Slopes, np.ndarray]:
    """Return smooth bumps of the rms `slope` (both axes together) and GGX of α = `width`."""
    slopes = _differences(_noise(size, np.random.default_rng(seed), 3.0, 3.0))
    slopes = slopes * slope / np.sqrt(np.mean(np.sum(slopes * slopes, axis=-1)))
    return slopes, entries_of_widths(width, width, np.zeros((size, size)))


def weave(size: int, seed: int) -> tuple[Slopes, np.ndarray]:
    """Return a twill: threads of 8 texels, two over and two under, each rough across its fibres."""
    rng = np.random.default_rng(seed)
    x, y = _grid(size)
    column, row = (x // 8).astype(int), (y // 8).astype(int)
    warp = (column + row) % 4 < 2
    # From −1 to 1 across a thread, and along the two crossings that it floats over.
    over_warp = ((row + column) % 4 + (y % 8) / 8) - 1
    over_weft = ((row + column - 2) % 4 + (x % 8) / 8) - 1
    side = np.where(warp, x % 8, y % 8) / 4 - 1
    float_along = np.clip(np.where(warp, over_warp, over_weft), -1, 1)
    across, along = 0.7 * side, 0.35 * float_along
    slopes = np.stack([np.where(warp, across, along), np.where(warp, along, across)], axis=-1)
    slopes = slopes + 0.03 * rng.standard_normal(slopes.shape)
    angle = np.where(warp, np.pi / 2, 0.0) + 0.1 * _noise(size, rng, 2.0, 2.0)
    return slopes, entries_of_widths(0.15, 0.35, angle)


def scratches(size: int, seed: int) -> tuple[Slopes, np.ndarray]:
    """Return a polished plane with straight grooves of 2 texels' half width in all directions."""
    rng = np.random.default_rng(seed)
    x, y = _grid(size)
    slopes = 0.02 * rng.standard_normal((size, size, 2))
    width = np.full((size, size), 0.08)
    for _ in range(size // 3):
        angle, place = rng.uniform(0, np.pi), rng.uniform(0, size, 2)
        normal = np.array([-np.sin(angle), np.cos(angle)])
        # The least distance from the line through the nearest copy of its centre.
        dx = (x - place[0] + size / 2) % size - size / 2
        dy = (y - place[1] + size / 2) % size - size / 2
        distance = dx * normal[0] + dy * normal[1]
        reach = np.abs(dx * normal[1] - dy * normal[0]) < size / 4
        inside = (np.abs(distance) < 2) & reach
        slopes[inside] = -rng.uniform(0.15, 0.6) * np.sign(distance[inside])[:, None] * normal
        width[inside] = 0.15
    return slopes, entries_of_widths(width, width, np.zeros((size, size)))


def foil(size: int, seed: int) -> tuple[Slopes, np.ndarray]:
    """Return crumpled foil: flat facets (Voronoi cells of about 8 × 8 texels) with random tilts."""
    rng = np.random.default_rng(seed)
    count = max((size // 8) ** 2, 4)
    sites = rng.uniform(0, size, (count, 2))
    tilts = 0.3 * rng.standard_normal((count, 2))
    x, y = _grid(size)
    cell = KDTree(sites, boxsize=size).query(np.stack([x, y], axis=-1))[1]
    return tilts[cell], entries_of_widths(0.1, 0.1, np.zeros((size, size)))


def brushed(size: int, seed: int) -> tuple[Slopes, np.ndarray]:
    """Return brushed metal: streaks along x of 40 × 1 texels, with slopes across them."""
    rng = np.random.default_rng(seed)
    across = 0.2 * _noise(size, rng, 40.0, 0.7)
    slopes = np.stack([0.02 * rng.standard_normal((size, size)), across], axis=-1)
    return slopes, entries_of_widths(0.08, 0.2, 0.05 * _noise(size, rng, 20.0, 1.0))


def spun(size: int, seed: int) -> tuple[Slopes, np.ndarray]:
    """Return spun metal: a flat plane, with the tangent around a centre near the middle."""
    rng = np.random.default_rng(seed)
    x, y = _grid(size)
    centre = size * rng.uniform(0.4, 0.6, 2)
    angle = np.arctan2(y - centre[1], x - centre[0]) + np.pi / 2
    return np.zeros((size, size, 2)), entries_of_widths(0.08, 0.35, angle)


def weak_bumps(size: int, seed: int) -> tuple[Slopes, np.ndarray]:
    """Return bumps of the rms slope 0.15 with α = 0.1."""
    return bumps(size, seed, slope=0.15, width=0.1)


def strong_bumps(size: int, seed: int) -> tuple[Slopes, np.ndarray]:
    """Return bumps of the rms slope 0.85 with α = 0.2."""
    return bumps(size, seed, slope=0.85, width=0.2)


MAPS: dict[str, Callable[[int, int], tuple[Slopes, np.ndarray]]] = {
    "weave": weave,
    "scratches": scratches,
    "weak-bumps": weak_bumps,
    "strong-bumps": strong_bumps,
    "foil": foil,
    "brushed": brushed,
    "spun": spun,
}


def synthetic_map(name: str, size: int, seed: int) -> LobeMap:
    """Return the map of lobes with a name of `MAPS`, of `size` × `size` texels.

    Raises ValueError for another name, and for a size that is no power of two of 16 or more.
    """
    if name not in MAPS:
        raise ValueError(f"map {name!r} is not known: allowed are {', '.join(MAPS)}")
    if size < 16 or size & (size - 1):
        raise ValueError(f"size = {size}: allowed are powers of two from 16 on")
    slopes, roughness = MAPS[name](size, seed)
    return LobeMap(slopes_to_normals(slopes), roughness)
