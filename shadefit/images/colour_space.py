"""The two colour spaces of values in image files: sRGB and linear."""

import numpy as np
from jaxtyping import Float

SRGB, LINEAR = "srgb", "linear"
COLOUR_SPACES = (SRGB, LINEAR)


def require_colour_space(name: str | None, what: str) -> str:
    """Return a colour space that was said; raise ValueError if it is none of `COLOUR_SPACES`."""
    if name is None:
        raise ValueError(f"{what}: its colour space is not said: say srgb or linear")
    if name not in COLOUR_SPACES:
        raise ValueError(f"{what}: colour space {name} is unknown: allowed are srgb, linear")
    return name


def convert_colour_space(
    pixels: Float[np.ndarray, "height width channels"], source: str, target: str
) -> Float[np.ndarray, "height width channels"]:
    """Return pixels in another colour space, by the curve of IEC 61966-2-1.

    `source` and `target` are 'srgb' or 'linear'. The last of two or four channels is alpha, which
    stays as it is. The curve is mirrored for negative values. The type of the array stays.
    """
    require_colour_space(source, "pixels")
    require_colour_space(target, "pixels")
    if source == target:
        return pixels
    colours = 1 if pixels.shape[2] <= 2 else 3
    value = np.abs(pixels[..., :colours])
    if target == LINEAR:
        bent = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    else:
        curve = 1.055 * np.maximum(value, 0.0031308) ** (1 / 2.4) - 0.055
        bent = np.where(value <= 0.0031308, value * 12.92, curve)
    converted = pixels.copy()
    converted[..., :colours] = np.copysign(bent, pixels[..., :colours])
    return converted
