"""One linear image of a scene: the average radiance of each pixel's samples."""

import numpy as np

from shadefit.render.fibers import azimuths
from shadefit.render.functions import Functions
from shadefit.render.scenes import Scene
from shadefit.render.settings import Settings
from shadefit.render.shade import shade

# A pixel has SAMPLES × SAMPLES samples.
SAMPLES = 2


def render_image(scene: Scene, settings: Settings, functions: Functions) -> np.ndarray:
    """Return one linear image (size, size, 3)."""
    hits = scene.hits(settings.size * SAMPLES)
    turns = azimuths(settings.fibers, hits)
    flat = shade(scene, hits, settings.material, settings.light, functions, turns)
    return flat.reshape(settings.size, SAMPLES, settings.size, SAMPLES, 3).mean(axis=(1, 3))
