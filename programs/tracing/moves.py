"""Primitives that only move the elements of arrays, in NumPy. JAX itself runs the few others.

JAX would compile each of them for each shape, which takes longer than a whole trace without it. The
elements may be numbers or, in arrays of dtype object, operands of a program.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np


def _broadcast_in_dim(operands: list[np.ndarray], params: Mapping[str, Any]) -> list[np.ndarray]:
    (x,), shape = operands, params["shape"]
    lined = [1] * len(shape)
    for axis, length in zip(params["broadcast_dimensions"], x.shape, strict=True):
        lined[axis] = length
    return [np.broadcast_to(x.reshape(lined), shape)]


def _dynamic_slice(operands: list[np.ndarray], params: Mapping[str, Any]) -> list[np.ndarray]:
    x, *starts = operands
    sizes = params["slice_sizes"]
    # As in JAX, a slice that would leave the array is moved into it.
    first = [
        min(max(int(start), 0), length - size)
        for start, length, size in zip(starts, x.shape, sizes, strict=True)
    ]
    return [x[tuple(slice(at, at + size) for at, size in zip(first, sizes, strict=True))]]


def _slice(operands: list[np.ndarray], params: Mapping[str, Any]) -> list[np.ndarray]:
    (x,), strides = operands, params["strides"] or (1,) * operands[0].ndim
    ends = zip(params["start_indices"], params["limit_indices"], strides, strict=True)
    return [x[tuple(slice(*each) for each in ends)]]


def _split(operands: list[np.ndarray], params: Mapping[str, Any]) -> list[np.ndarray]:
    return np.split(operands[0], np.cumsum(params["sizes"])[:-1], axis=params["axis"])


# Primitive -> a function of its operands and parameters that returns its results
MOVES: dict[str, Callable[[list[np.ndarray], Mapping[str, Any]], list[np.ndarray]]] = {
    "broadcast_in_dim": _broadcast_in_dim,
    "concatenate": lambda operands, params: [np.concatenate(operands, axis=params["dimension"])],
    "dynamic_slice": _dynamic_slice,
    "reshape": lambda operands, params: [operands[0].reshape(params["new_sizes"])],
    "rev": lambda operands, params: [np.flip(operands[0], params["dimensions"])],
    "slice": _slice,
    "split": _split,
    "squeeze": lambda operands, params: [np.squeeze(operands[0], params["dimensions"])],
    "stack": lambda operands, params: [np.stack(operands, axis=params["axis"])],
    "transpose": lambda operands, params: [np.transpose(operands[0], params["permutation"])],
}
