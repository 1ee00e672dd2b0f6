"""The values of one primitive of JAX on numbers. Those that only move elements are left to NumPy.

JAX compiles a primitive for each shape, which takes 20 ms. NumPy moves elements at once.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from jax.extend.core import JaxprEqn

Params = Mapping[str, Any]


def values_of(equation: JaxprEqn, operands: Sequence[np.ndarray | np.generic]) -> list[np.ndarray]:
    """Return the results of a primitive on numeric arrays."""
    move = _MOVES.get(equation.primitive.name)
    if move is not None:
        return move(equation.params, *operands)
    results = equation.primitive.bind(*operands, **equation.params)
    results = results if equation.primitive.multiple_results else [results]
    return [np.asarray(result) for result in results]


def _broadcast(params: Params, x: Any) -> list[np.ndarray]:
    sizes = [1] * len(params["shape"])
    for size, dimension in zip(x.shape, params["broadcast_dimensions"], strict=True):
        sizes[dimension] = size
    return [np.broadcast_to(x.reshape(sizes), params["shape"])]


def _slice(params: Params, x: Any) -> list[np.ndarray]:
    strides = params["strides"] or [1] * x.ndim
    ends = zip(params["start_indices"], params["limit_indices"], strides, strict=True)
    return [x[tuple(slice(*each) for each in ends)]]


def _split(params: Params, x: Any) -> list[np.ndarray]:
    return np.split(x, np.cumsum(params["sizes"])[:-1], params["axis"])


_MOVES: dict[str, Callable[..., list[np.ndarray]]] = {
    "broadcast_in_dim": _broadcast,
    "concatenate": lambda params, *several: [np.concatenate(several, params["dimension"])],
    "reshape": lambda params, x: [x.reshape(params["new_sizes"])],
    "rev": lambda params, x: [np.flip(x, params["dimensions"])],
    "slice": _slice,
    "split": _split,
    "stack": lambda params, *several: [np.stack(several, params["axis"])],
    "squeeze": lambda params, x: [np.squeeze(x, tuple(params["dimensions"]))],
    "transpose": lambda params, x: [np.transpose(x, params["permutation"])],
}
