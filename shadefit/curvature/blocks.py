"""Functions of one triangle, point or pair of `shading.curvature`, over arrays of any length."""

import functools
from collections.abc import Callable

import jax
import numpy as np

# All calls have this length, so that each function is compiled once for small arrays, and once for
# large ones.
_SMALL, _LARGE = 1024, 32768


def over_rows(function: Callable, *arrays: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the results of a function of one row, (n, …) each, at the rows of arrays (n, …).

    The function returns a tuple of arrays. It is computed in float64. Raises ValueError if JAX is
    not set to float64.
    """
    if not jax.config.read("jax_enable_x64"):
        raise ValueError("curvature needs float64: set JAX_ENABLE_X64=1")
    count = len(arrays[0])
    size = _SMALL if count <= 8 * _SMALL else _LARGE
    compiled = _compiled(function)
    parts = []
    for start in range(0, max(count, 1), size):
        rows = [each[start : start + size] for each in arrays]
        short = size - len(rows[0])
        padded = [np.pad(each, [(0, short), *[(0, 0)] * (each.ndim - 1)]) for each in rows]
        parts.append([np.asarray(each)[: size - short] for each in compiled(*padded)])
    return tuple(np.concatenate(each) for each in zip(*parts, strict=True))


@functools.cache
def _compiled(function: Callable) -> Callable:
    return jax.jit(jax.vmap(function))
