"""The errors of filters on synthetic maps: total variation of the normals, and radiance."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from shadefit.maps.filters import FILTERS, filter_chain
from shadefit.maps.lobes import lobe_matrices, slope_moments
from shadefit.maps.synthetic import MAPS, synthetic_map
from shadefit.maps.truth import (
    best_lobe_by_descent,
    footprint_grid,
    lit_plane,
    radiance,
    total_variation,
)

# The level of the chain that is judged: footprints of 16 × 16 texels.
LEVEL = 4
_PLANE = 24


@dataclass(frozen=True)
class FilterErrors:
    """Errors of one filter on one map, averaged over its footprints.

    `total_variation` is ½ ∫ |p − q| of slope densities. `radiance` is the rms error of the
    radiance of a lit plane, relative to its mean.
    """

    map: str
    method: str
    total_variation: float
    radiance: float


def filter_errors(
    maps: Sequence[str] = tuple(MAPS),
    methods: Sequence[str] = FILTERS,
    *,
    footprints: int = 8,
    size: int = 64,
    seed: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> list[FilterErrors]:
    """Return the errors of each filter on each map, and those of the best single lobe.

    All filters are judged on the same `footprints` of 16 × 16 texels, drawn by `seed`. The method
    `best` is a lobe found for each footprint by descent. Raises ValueError for unknown names, and
    for more footprints than a map of `size` has.
    """
    available = (size >> LEVEL) ** 2
    if not 1 <= footprints <= available:
        raise ValueError(f"footprints = {footprints}: allowed are 1 to {available}")
    found = []
    eye, light = lit_plane(_PLANE)
    for done, name in enumerate(maps):
        base = synthetic_map(name, size, seed)
        levels = {method: filter_chain(base, method)[LEVEL] for method in methods}
        start = filter_chain(base, "lean")[LEVEL]
        drawn = np.random.default_rng(seed).permutation(available)[:footprints]
        errors: dict[str, list[tuple[float, float]]] = {each: [] for each in (*methods, "best")}
        for row, column in zip(*np.divmod(drawn, size >> LEVEL), strict=True):
            cut = np.s_[row * 16 : row * 16 + 16, column * 16 : column * 16 + 16]
            texels = base.normals[cut].reshape(-1, 3), base.roughness[cut].reshape(-1, 3)
            grid = footprint_grid(*texels)
            exact = np.mean(radiance(*texels, eye, light), axis=0)
            lobes = {
                each: (level.normals[row, column], level.roughness[row, column])
                for each, level in levels.items()
            }
            first = lobe_matrices(start.normals[row, column], start.roughness[row, column])
            lobes["best"] = best_lobe_by_descent(grid, *slope_moments(first))
            for each, lobe in lobes.items():
                error = radiance(*lobe, eye, light) - exact
                relative = np.sqrt(np.mean(error**2)) / np.mean(exact)
                errors[each].append((total_variation(grid, *lobe), float(relative)))
        for each, pairs in errors.items():
            variation, rms = np.mean(pairs, axis=0)
            found.append(FilterErrors(name, each, float(variation), float(rms)))
        if progress is not None:
            progress(done + 1, len(maps))
    return found
