"""Linear images of a scene: the average radiance of each pixel's samples."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from shadefit.memory import trim
from shadefit.render.fibers import azimuths
from shadefit.render.functions import Functions
from shadefit.render.scenes import Hits, Scene
from shadefit.render.settings import Settings
from shadefit.render.shade import shade

# A pixel has SAMPLES × SAMPLES samples.
SAMPLES = 2
# The edge of the large image in pixels, and the samples along an edge of its pixels.
LARGE, LARGE_SAMPLES = 720, 3
# An image is rendered in bands of at most so many samples, because all at once would need
# gigabytes.
_BAND, _LARGE_BAND = 1 << 17, 1 << 17


Progress = Callable[[int, int], None]


def silent(done: int, total: int) -> None:
    """Tell nobody how many bands are done."""


def render_images(
    scene: Scene, wanted: Sequence[tuple[Settings, Functions]], progress: Progress = silent
) -> list[np.ndarray]:
    """Return linear images (size, size, 3) of one scene, one for each choice of `wanted`.

    All settings have the same size. The images are rendered together, band by band.
    """
    size = wanted[0][0].size
    images = [np.empty((size, size, 3)) for _ in wanted]
    bands = _bands(size, SAMPLES, _BAND)
    # Compiling one image uses one core; a second thread uses another core for the next image.
    with ThreadPoolExecutor(2) as workers:
        for number, (top, bottom) in enumerate(bands):
            progress(number, len(bands))
            hits = scene.hits(size * SAMPLES, (top * SAMPLES, bottom * SAMPLES))

            def pixels(each: tuple[Settings, Functions], hits: Hits = hits) -> np.ndarray:
                return _pixels(scene, *each, hits, size, SAMPLES)

            for image, band in zip(images, workers.map(pixels, wanted), strict=True):
                image[top:bottom] = band
            if number == 0:
                # Everything is compiled now, which took memory.
                trim()
    return images


def render_image(scene: Scene, settings: Settings, functions: Functions) -> np.ndarray:
    """Return one linear image (size, size, 3)."""
    (image,) = render_images(scene, [(settings, functions)])
    return image


def render_large(
    scene: Scene, settings: Settings, functions: Functions, progress: Progress = silent
) -> np.ndarray:
    """Return one linear image (n, n, 3) of many pixels and samples.

    n is `LARGE`, but at least `settings.size` and at most three times as much. A pixel has
    `LARGE_SAMPLES` × `LARGE_SAMPLES` samples.
    """
    size, samples = max(settings.size, min(LARGE, 3 * settings.size)), LARGE_SAMPLES
    bands, images = _bands(size, samples, _LARGE_BAND), []
    for number, (top, bottom) in enumerate(bands):
        progress(number, len(bands))
        hits = scene.hits(size * samples, (top * samples, bottom * samples))
        images.append(_pixels(scene, settings, functions, hits, size, samples))
        if number == 0:
            trim()
    return np.concatenate(images)


def _bands(size: int, samples: int, most: int) -> list[tuple[int, int]]:
    """Return the first row of pixels of each band, and the one after its last."""
    height = max(1, most // (size * samples**2))
    return [(top, min(top + height, size)) for top in range(0, size, height)]


def _pixels(
    scene: Scene, settings: Settings, functions: Functions, hits: Hits, size: int, samples: int
) -> np.ndarray:
    """Return the pixels (rows, size, 3) of complete rows of samples."""
    turns = azimuths(settings.fibers, hits)
    flat = shade(scene, hits, settings.material, settings.light, functions, turns)
    return flat.reshape(-1, samples, size, samples, 3).mean(axis=(1, 3))
