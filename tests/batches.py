"""Evaluate functions of one point at many, compiled once for all counts of points."""

import jax
import numpy as np


def batched(function, width: int):
    """Give `function` of a point as one of arrays (n, ...), compiled for batches of `width` points.

    The last batch is filled up with its last point. Results are NumPy arrays (n, ...), in the
    tuples that `function` returns.
    """
    compiled = jax.jit(jax.vmap(function))

    def evaluate(*columns):
        columns = [np.asarray(column, float) for column in columns]
        count = len(columns[0])
        last = np.minimum(np.arange(count + -count % width), count - 1)
        filled = [column[last] for column in columns]
        results = [
            compiled(*(column[start : start + width] for column in filled))
            for start in range(0, len(filled[0]), width)
        ]
        return jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *results)

    return evaluate
