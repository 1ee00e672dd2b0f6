"""The types of texels, and how values are rounded to them."""

from typing import Literal

import numpy as np

Texel = Literal["float32", "float16", "unorm16", "unorm8"]

# The types in which texels are stored.
_FLOATS = {"float32": np.float32, "float16": np.float16}
_UNORMS = {"unorm16": np.uint16, "unorm8": np.uint8}


def encoded(values: np.ndarray, texel: Texel) -> tuple[np.ndarray, tuple[float, float]]:
    """Return values (…) as texels (…) of a type, and the values of the texels 0 and 1.

    For floats these are 0 and 1, else the least and the largest value unless all are in [0, 1].
    Raises ValueError for values that are too large for the type.
    """
    if texel in _FLOATS:
        largest = float(np.finfo(_FLOATS[texel]).max)
        for beyond in values[np.abs(values) > largest][:1]:
            raise ValueError(f"value {beyond:g}: allowed in {texel} are ±{largest:g}")
        return values.astype(_FLOATS[texel]), (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    if low >= 0 and high <= 1:
        low, high = 0.0, 1.0
    elif low == high:
        high = low + 1
    kind = _UNORMS[texel]
    steps = np.iinfo(kind).max
    return np.round((values - low) / (high - low) * steps).astype(kind), (low, high)


def decoded(stored: np.ndarray, span: tuple[float, float]) -> np.ndarray:
    """Return the values (…) of texels (…) in float64; `span` has those of the texels 0 and 1."""
    values = stored.astype(float)
    if np.issubdtype(stored.dtype, np.integer):
        values = values / np.iinfo(stored.dtype).max
    low, high = span
    return values if span == (0.0, 1.0) else low + (high - low) * values
