"""Mip chains of maps of lobes, by six filters and a closed form.

* `naive`: the mean of the encoded maps, as if they were colours.
* `clean`: CLEAN mapping, the variance of slopes without its direction.
* `lean`: LEAN mapping, twice the covariance of slopes.
* `sggx`: the mean of SGGX matrices (Patry 2020): once the covariance of slopes.
* `estimated`: the SGGX matrix with the mean projected areas along its axes (Heitz et al. 2015).
* `fitted`: moments of slopes, and the table `sggx-filter-axes` of the best lobe's widening.
* `kl`: the lobe with the least Kullback–Leibler divergence of the footprint's normals.

Maps are square or not; their sides are powers of two. They are processed in strips, so that memory
beside the maps and the result does not grow with their height.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from shadefit.images.image import bands
from shadefit.maps.best_lobe import STEPS, best_lobe, slopes_of_lobes, unit_slopes
from shadefit.maps.lobes import (
    Normals,
    Roughness,
    lobe_matrices,
    lobes_of_matrices,
    matrices_of_slopes,
    slope_moments,
)
from shadefit.maps.moments import AVERAGING, slope_features, split_features, widened

FILTERS = ("naive", "clean", "lean", "sggx", "estimated", "fitted", "kl")
# A level is made from the lobes of the level this far below it, or from the texels themselves.
DEPTH = 4
# Texels that are processed at once.
BLOCK = 1 << 18
# Radii and angles of the slopes that stand for a lobe, by the number of halvings: few lobes need
# many slopes each, and 256 lobes are a good sample with 6.
_SLOPES = {1: (3, 3), 2: (2, 3), 3: (1, 3), 4: (1, 3)}

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class LobeMap:
    """One level of a chain: unit normals (height, width, 3) and roughness (height, width, 3)."""

    normals: Normals
    roughness: Roughness

    @property
    def size(self) -> tuple[int, int]:
        """The height and the width."""
        height, width, _ = self.normals.shape
        return height, width


def lobe_map(normals: np.ndarray, roughness: np.ndarray) -> LobeMap:
    """Return a map of lobes in float64 after checks.

    Raises ValueError for shapes that differ, sides that are no powers of two, numbers that are not
    finite, normals that are not unit vectors with z > 0, and roughness that is not positive
    definite with widths in (0, 1].
    """
    normals, roughness = np.asarray(normals, float), np.asarray(roughness, float)
    for name, each in (("normals", normals), ("roughness", roughness)):
        if each.ndim != 3 or each.shape[-1] != 3:
            raise ValueError(f"{name} of shape {each.shape}: allowed is (height, width, 3)")
    if normals.shape != roughness.shape:
        raise ValueError(f"roughness of shape {roughness.shape}: allowed is {normals.shape}")
    for side, name in zip(normals.shape[:2], ("height", "width"), strict=True):
        if side < 1 or side & (side - 1):
            raise ValueError(f"{name} = {side}: allowed are powers of two")
    for rows in bands(len(normals)):
        _require_lobes(normals[rows], roughness[rows])
    return LobeMap(normals, roughness)


def _require_lobes(normals: Normals, roughness: Roughness) -> None:
    for name, each in (("normals", normals), ("roughness", roughness)):
        if not np.all(np.isfinite(each)):
            raise ValueError(f"{name} with NaN or infinity: allowed are finite numbers")
    length = np.sqrt(np.sum(normals * normals, axis=-1))
    worst = float(np.max(np.abs(length - 1)))
    if worst > 1e-6:
        raise ValueError(f"a normal with |length − 1| = {worst:.3g}: allowed are unit normals")
    if np.min(normals[..., 2]) <= 0:
        raise ValueError(f"a normal with z = {np.min(normals[..., 2]):.3g}: allowed is z > 0")
    xx, xy, yy = (roughness[..., k] for k in range(3))
    if not np.all((xx > 0) & (yy > 0) & (xx * yy > xy * xy)):
        raise ValueError(
            "roughness with a width that is not positive: allowed are widths in (0, 1]"
        )
    largest = float(np.max((xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)))
    if largest > 1 + 1e-6:
        raise ValueError(
            f"roughness with the width {largest**0.5:.4g}: allowed are widths in (0, 1]"
        )


def filter_chain(
    base: LobeMap, method: str, *, block: int = BLOCK, progress: Progress | None = None
) -> list[LobeMap]:
    """Return the levels of a mip chain, the given one first and one of 1 × 1 last.

    `method` is one of `FILTERS`. `block` is the number of texels that are processed at once.
    `progress` is called with the numbers of texels that are done and of all. Raises ValueError for
    another method and for a block below 1024.
    """
    if method not in FILTERS:
        raise ValueError(f"filter {method!r} is not known: allowed are {', '.join(FILTERS)}")
    if block < 1024:
        raise ValueError(f"block = {block}: allowed are 1024 texels or more")
    make = _by_averages if method in AVERAGING else _by_footprints
    levels = [base]
    tell = _Told(progress, base)
    for level in make(base, method, block, tell):
        levels.append(level)
    tell.end()
    return levels


class _Told:
    """The progress: texels of the base map that are done, summed over passes."""

    def __init__(self, progress: Progress | None, base: LobeMap) -> None:
        self.progress = progress
        self.done, self.all = 0, base.size[0] * base.size[1]

    def expect(self, texels: int) -> None:
        self.done, self.all = 0, texels

    def add(self, texels: int) -> None:
        self.done += texels
        if self.progress is not None:
            self.progress(min(self.done, self.all), self.all)

    def end(self) -> None:
        if self.progress is not None:
            self.progress(self.all, self.all)


def halved(values: np.ndarray) -> np.ndarray:
    """Return the means of 2 × 2 texels (or of 2, where a side is 1) of an array (h, w, k)."""
    if values.shape[0] > 1:
        values = (values[0::2] + values[1::2]) / 2
    if values.shape[1] > 1:
        values = (values[:, 0::2] + values[:, 1::2]) / 2
    return values


def _strips(height: int, width: int, block: int, multiple: int) -> Iterator[slice]:
    """Yield slices of rows with about `block` texels, each a multiple of `multiple` rows."""
    rows = max(block // (width * multiple), 1) * multiple
    for start in range(0, height, rows):
        yield slice(start, min(start + rows, height))


def _by_averages(base: LobeMap, method: str, block: int, tell: _Told) -> Iterator[LobeMap]:
    averaging = AVERAGING[method]
    height, width = base.size
    tell.expect(height * width * 4 // 3)
    if height * width == 1:
        return
    parts = []
    for rows in _strips(height, width, block, 2):
        features = averaging.features(base.normals[rows], base.roughness[rows])
        parts.append(halved(features))
        tell.add(features.shape[0] * width)
    means = np.concatenate(parts)
    while True:
        yield _in_strips(averaging.lobes, means, block, tell)
        if means.shape[:2] == (1, 1):
            return
        means = halved(means)


def _in_strips(lobes: Callable, means: np.ndarray, block: int, tell: _Told) -> LobeMap:
    height, width, _ = means.shape
    found = []
    for rows in _strips(height, width, block, 1):
        found.append(lobes(means[rows]))
        tell.add(means[rows].shape[0] * width)
    return LobeMap(*(np.concatenate(each) for each in zip(*found, strict=True)))


def _by_footprints(base: LobeMap, method: str, block: int, tell: _Told) -> Iterator[LobeMap]:
    make = {"estimated": _estimated, "kl": _best}[method]
    levels = [base]
    height, width = base.size
    count = max(height, width).bit_length() - 1
    sources = [max(level - DEPTH, 0) for level in range(1, count + 1)]
    tell.expect(sum(_texels(height, source) * _texels(width, source) for source in sources))
    for level, source in zip(range(1, count + 1), sources, strict=True):
        below = levels[source]
        down = level - source
        sides = [min(1 << down, side) for side in below.size]
        found = []
        for rows in _strips(*below.size, max(block // 4, below.size[1] * sides[0]), sides[0]):
            footprints = [
                _footprints(each[rows], *sides) for each in (below.normals, below.roughness)
            ]
            found.append(make(*footprints, down))
            tell.add(footprints[0].shape[0] * below.size[1] * sides[0])
        new = LobeMap(*(np.concatenate(each) for each in zip(*found, strict=True)))
        levels.append(new)
        yield new


def _texels(side: int, level: int) -> int:
    return max(side >> level, 1)


def _footprints(values: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Return values (h, w, k) as (h/rows, w/columns, rows · columns, k)."""
    height, width, size = values.shape
    cut = values.reshape(height // rows, rows, width // columns, columns, size)
    return cut.transpose(0, 2, 1, 3, 4).reshape(height // rows, width // columns, -1, size)


def _estimated(
    normals: np.ndarray, roughness: np.ndarray, _down: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return lobes with the axes of the mean matrix and the mean projected areas along them."""
    matrices = lobe_matrices(normals, roughness)
    xx, xy, xz, yy, yz, zz = np.moveaxis(np.mean(matrices, axis=-2), -1, 0)
    rows = np.stack([np.stack(row, -1) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))], -2)
    axes = np.linalg.eigh(rows)[1]
    result = np.zeros((*xx.shape, 6))
    for k in range(3):
        x, y, z = (axes[..., i, k] for i in range(3))
        square = np.stack([x * x, 2 * x * y, 2 * x * z, y * y, 2 * y * z, z * z], axis=-1)
        areas = np.sqrt(np.maximum(np.einsum("...kj,...j->...k", matrices, square), 0))
        outer = square * np.array([1, 0.5, 0.5, 1, 0.5, 1])
        result += (np.mean(areas, axis=-1) ** 2)[..., None] * outer
    return lobes_of_matrices(result)


def _best(normals: np.ndarray, roughness: np.ndarray, down: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the best lobes of footprints, from that of the table."""
    matrices = lobe_matrices(normals, roughness)
    mean, spread = slope_moments(matrices)
    averages = split_features(np.mean(slope_features(normals, roughness), axis=-2))
    unit = unit_slopes(mean.shape[-2], *_SLOPES[down])
    slopes = slopes_of_lobes(mean, spread, unit)
    # D(h) is the density of slopes times √S₃₃, and the same factor for all lobes.
    weights = np.repeat(np.sqrt(matrices[..., 5]), unit.shape[1], axis=-1)
    start = averages[0], widened(averages[2], averages[1])
    return lobes_of_matrices(matrices_of_slopes(*best_lobe(slopes, weights, *start, STEPS)))
