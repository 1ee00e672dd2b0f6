"""Points in batches of one size, so that JAX compiles a function once for any number of points."""

from collections.abc import Callable

import jax
import numpy as np


class Batches:
    """Points (n, axes), with n > 0, in batches of one size, which are `parts`.

    The last batch is filled with copies of the last point. The batches are on the device, for any
    number of functions that are evaluated at them.
    """

    def __init__(self, points: np.ndarray, batch: int) -> None:
        self.count = len(points)
        filled = np.concatenate([points, np.repeat(points[-1:], -self.count % batch, axis=0)])
        self.parts = [
            jax.device_put(filled[first : first + batch]) for first in range(0, self.count, batch)
        ]

    def evaluate(self, function: Callable):
        """Return the arrays (batch, …) that `function` returns for each batch, joined to (n, …)."""
        parts = [function(each) for each in self.parts]
        return jax.tree.map(lambda *each: np.concatenate(each)[: self.count], *parts)


def in_batches(function: Callable, points: np.ndarray, batch: int):
    """Apply `function` to points (n, axes), with n > 0, in batches of `batch` points.

    Returns the arrays that `function` returns, joined to (n, …), on the device.
    """
    return jax.tree.map(jax.device_put, Batches(points, batch).evaluate(function))
