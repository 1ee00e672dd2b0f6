"""Curvature in four bytes a vertex, and what that loses."""

import jax
import numpy as np
from jaxtyping import Float, Int8

from shadefit.curvature.blocks import over_rows
from shadefit.curvature.tensors import Tensors
from shading.curvature import packed, unpacked
from shading.curvature.packing import RANGE

Bytes = Int8[np.ndarray, "n 4"]


def to_bytes(tensors: Tensors, largest: float = RANGE) -> Bytes:
    """Return tensors (n, 3) as signed bytes (n, 4) of the range ±`largest` in 1/mm.

    The fourth byte is the mean curvature. Raises ValueError for a range that is not positive.
    """
    require_range(largest)
    codes = over_rows(_packed, tensors, np.full(len(tensors), float(largest)))[0]
    return codes.astype(np.int8)


def from_bytes(codes: Bytes, largest: float = RANGE) -> Float[np.ndarray, "n 4"]:
    """Return tensors and mean curvature (n, 4) in 1/mm of signed bytes (n, 4)."""
    require_range(largest)
    return over_rows(_unpacked, codes.astype(float), np.full(len(codes), float(largest)))[0]


def clamped_count(tensors: Tensors, largest: float = RANGE) -> int:
    """Count the tensors with an entry beyond the range, which is clamped in bytes."""
    return int(np.sum(np.abs(tensors).max(axis=1) > largest))


def require_range(largest: float) -> None:
    """Raise ValueError unless the range is positive and finite."""
    if not 1e-6 <= largest <= 1e6:
        raise ValueError(f"range = {largest:g}: allowed are 1e-6 to 1e6, in 1/mm")


def _packed(tensor: jax.Array, largest: jax.Array) -> tuple[jax.Array]:
    return (packed(tensor, largest),)


def _unpacked(codes: jax.Array, largest: jax.Array) -> tuple[jax.Array]:
    return (unpacked(codes, largest),)
