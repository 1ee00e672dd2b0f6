"""Conversion between linear RGB, in which light is computed, and sRGB, which screens show."""

import re

import numpy as np


def to_srgb(linear: np.ndarray) -> np.ndarray:
    """Return sRGB values (…) in [0, 1] for linear colours (…) ≥ 0.

    Values up to 0.8 are converted as the standard says; brighter ones approach 1 smoothly.
    """
    x = np.maximum(linear, 0)
    x = np.where(x > 0.8, 1 - 0.2 * np.exp(-(x - 0.8) / 0.2), x)
    return np.where(
        x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 0.0031308) ** (1 / 2.4) - 0.055
    )


def from_srgb(encoded: np.ndarray) -> np.ndarray:
    """Return linear colours (…) in [0, 1] for sRGB values (…) in [0, 1], as the standard says."""
    low, high = encoded / 12.92, ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high)


def parse_colour(text: str, name: str) -> tuple[float, float, float]:
    """Return the linear RGB of '#rrggbb'; `name` is the option that the text was given for.

    Raises ValueError, which names the option, for any other text.
    """
    if not re.fullmatch("#?[0-9a-fA-F]{6}", text):
        raise ValueError(f"{name} is {text!r}; allowed: a colour as #rrggbb")
    values = np.frombuffer(bytes.fromhex(text.removeprefix("#")), np.uint8) / 255
    red, green, blue = (float(x) for x in from_srgb(values))
    return red, green, blue
