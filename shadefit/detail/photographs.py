"""Photographs of materials, and paintings on them, to measure detail maps on.

The photographs are those of the library scikit-image: `gravel`, `brick` and `grass` (CC0) and
`coffee` (no copyright restrictions, CC0 by Rachel Michetti), as its docstrings say. The first three
are grey, so that colours are given to them: a dark one for black and a light one for white.
"""

import numpy as np
from jaxtyping import Float

from shadefit.images.optional_libraries import optional_library

EDGE = 256
Picture = Float[np.ndarray, "height width 3"]

# The sRGB colours of black and white of a grey photograph
_COLOURS = {
    "gravel": ((0.10, 0.09, 0.08), (0.85, 0.82, 0.78)),
    "brick": ((0.16, 0.07, 0.05), (0.82, 0.56, 0.44)),
    "grass": ((0.04, 0.08, 0.02), (0.62, 0.78, 0.36)),
}
MATERIALS = (*_COLOURS, "coffee")
PAINTINGS = ("grime", "wear", "tint")


def photograph(name: str) -> Picture:
    """Return a material (256, 256, 3) in [0, 1], in sRGB values of 8 bits."""
    taken = np.asarray(getattr(optional_library("skimage.data"), name)(), float) / 255
    crop = taken[:EDGE, :EDGE]
    if name in _COLOURS:
        dark, light = (np.array(each) for each in _COLOURS[name])
        crop = dark + crop[..., None] * (light - dark)
    return np.round(crop * 255) / 255


def painted(material: Picture, painting: str) -> Picture:
    """Return a target: the material with something painted on it, in sRGB values of 8 bits.

    'grime' darkens in soft spots and streaks, 'wear' brightens them, and 'tint' mixes a colour in.
    The shapes are the same for all materials.
    """
    mask = _spots()[: material.shape[0], : material.shape[1], None]
    if painting == "grime":
        result = material * (1 - 0.65 * mask) + 0.03 * mask
    elif painting == "wear":
        result = material + (0.85 - 0.4 * material) * 0.5 * mask
    elif painting == "tint":
        colour = np.array([0.25, 0.42, 0.55])
        result = material + 0.45 * mask * (colour - material)
    else:
        raise ValueError(f"painting {painting}: allowed are {', '.join(PAINTINGS)}")
    return np.round(np.clip(result, 0, 1) * 255) / 255


def _spots() -> np.ndarray:
    """Return a smooth mask (256, 256) in [0, 1]: a sum of waves. The seed fixes it."""
    rng = np.random.default_rng(2020)
    y, x = np.mgrid[:EDGE, :EDGE] / EDGE
    total = np.zeros((EDGE, EDGE))
    for _ in range(12):
        length, angle, phase = rng.uniform(0.15, 0.7), rng.uniform(0, np.pi), rng.uniform(0, 7)
        total += length * np.sin(
            2 * np.pi * (x * np.cos(angle) + y * np.sin(angle)) / length + phase
        )
    return 1 / (1 + np.exp(-4 * total))
