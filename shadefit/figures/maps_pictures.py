"""The picture of filtered maps: the highlight on a plane, through the levels of a mip chain."""

import numpy as np
from matplotlib.figure import Figure

from shadefit.figures.picture import Picture
from shadefit.maps.filters import LobeMap, filter_chain
from shadefit.maps.synthetic import synthetic_map
from shadefit.maps.truth import lit_plane, radiance

_MAP, _SIZE, _SEED = "scratches", 64, 1
_METHODS = {"naive": "naive", "lean": "LEAN", "sggx": "SGGX", "kl": "least divergence"}
_LEVELS = (2, 4, 6)
# Points along each side of the plane, and the fraction of the truth's brightest radiance that is
# white, so that the tails can be seen too.
_POINTS, _WHITE = 96, 0.7
# Points of the plane that are shaded at once, so that memory is bounded
_CHUNK = 1024


def maps_pictures() -> dict[str, Picture]:
    """Return the picture of the filters of maps, by name."""
    return {
        "maps-highlight": Picture(
            "A highlight on filtered scratches",
            "The highlight of a small lamp on a plane whose every point has one texel of a "
            "level of the mip chain of the synthetic map of scratches: on the right the mean "
            "over the 16, 256 or 4096 lobes of its footprint, before it the one lobe that each "
            "filter leaves of them. Numbers are rms errors of radiance, divided by its mean. "
            "The naive mean forgets the slopes, and is too bright in levels 2 and 4. LEAN adds "
            "twice their covariance, which is too wide in levels 4 and 6. No single lobe has "
            "both the core and the halo.",
            draw_highlight,
        )
    }


def shown(name: str, size: int, seed: int, points: int) -> dict[int, dict[str, np.ndarray]]:
    """Return the radiance (points, points) of one texel of each level: in truth and by filter."""
    base = synthetic_map(name, size, seed)
    chains = {method: filter_chain(base, method) for method in _METHODS}
    eye, light = lit_plane(points)
    found = {}
    for level in _LEVELS:
        # The texel that covers the middle of the map.
        side = 1 << level
        at = (size >> level) // 2
        cut = np.s_[at * side : (at + 1) * side, at * side : (at + 1) * side]
        truth = LobeMap(base.normals[cut], base.roughness[cut])
        lobes = {"truth": truth} | {
            method: LobeMap(*(each[at : at + 1, at : at + 1] for each in _parts(chain[level])))
            for method, chain in chains.items()
        }
        found[level] = {
            label: _mean_radiance(each, eye, light).reshape(points, points)
            for label, each in lobes.items()
        }
    return found


def _parts(level: LobeMap) -> tuple[np.ndarray, np.ndarray]:
    return level.normals, level.roughness


def _mean_radiance(lobes: LobeMap, eye: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Return the mean radiance (points,) of all texels of a map."""
    normals, roughness = (each.reshape(-1, 3) for each in _parts(lobes))
    parts = [
        np.mean(radiance(normals, roughness, eye[first:end], light[first:end]), axis=0)
        for first in range(0, len(eye), _CHUNK)
        for end in (first + _CHUNK,)
    ]
    return np.concatenate(parts)


def draw_highlight() -> Figure:
    """Draw the highlight in truth and by each filter, a row a level."""
    found = shown(_MAP, _SIZE, _SEED, _POINTS)
    labels = {**_METHODS, "truth": "truth"}
    figure = Figure(figsize=(9.4, 6.2), layout="constrained")
    panels = figure.subplots(len(_LEVELS), len(labels))
    for row, (level, images) in zip(panels, found.items(), strict=True):
        truth = images["truth"]
        white = _WHITE * np.max(truth)
        for panel, (name, label) in zip(row, labels.items(), strict=True):
            shade = np.clip(images[name] / white, 0, 1) ** (1 / 2.2)
            panel.imshow(shade, cmap="gray", vmin=0, vmax=1, origin="lower")
            panel.set(xticks=[], yticks=[])
            error = np.sqrt(np.mean((images[name] - truth) ** 2)) / np.mean(truth)
            panel.set_title(label if name == "truth" else f"{label}: {error:.2f}")
        row[0].set_ylabel(f"level {level}: {1 << level}² texels")
    return figure
