"""One linear image of a scene: the average radiance of each pixel's samples."""

import numpy as np

from shadefit.render.fibers import azimuths
from shadefit.render.functions import Functions
from shadefit.render.scenes import Hits, Scene
from shadefit.render.settings import Settings
from shadefit.render.shade import shade

# A pixel has SAMPLES × SAMPLES samples.
SAMPLES = 2
# The edge of the large image in pixels, and the samples along an edge of its pixels.
LARGE, LARGE_SAMPLES = 720, 3
# A large image is rendered in bands of at most this many samples, because all at once would need
# gigabytes.
_BAND = 1 << 19


def render_image(
    scene: Scene, settings: Settings, functions: Functions, hits: Hits | None = None
) -> np.ndarray:
    """Return one linear image (size, size, 3).

    `hits` are those of the scene at `settings.size` × `SAMPLES`, if they are known already.
    """
    hits = hits or scene.hits(settings.size * SAMPLES)
    return _pixels(scene, settings, functions, hits, settings.size, SAMPLES)


def render_large(scene: Scene, settings: Settings, functions: Functions) -> np.ndarray:
    """Return one linear image (n, n, 3) of many pixels and samples.

    n is `LARGE`, but at least `settings.size` and at most three times as much. A pixel has
    `LARGE_SAMPLES` × `LARGE_SAMPLES` samples.
    """
    size, samples = max(settings.size, min(LARGE, 3 * settings.size)), LARGE_SAMPLES
    height = max(1, _BAND // (size * samples**2))
    bands = []
    for top in range(0, size, height):
        rows = (top * samples, min(top + height, size) * samples)
        hits = scene.hits(size * samples, rows)
        bands.append(_pixels(scene, settings, functions, hits, size, samples))
    return np.concatenate(bands)


def _pixels(
    scene: Scene, settings: Settings, functions: Functions, hits: Hits, size: int, samples: int
) -> np.ndarray:
    """Return the pixels (rows, size, 3) of complete rows of samples."""
    turns = azimuths(settings.fibers, hits)
    flat = shade(scene, hits, settings.material, settings.light, functions, turns)
    return flat.reshape(-1, samples, size, samples, 3).mean(axis=(1, 3))
