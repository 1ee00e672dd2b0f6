"""The operators of detail maps for whole images, by name."""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from shading import detail

Values = np.ndarray


@dataclass(frozen=True)
class Operator:
    """An operator f(s, d), its inverse s(t, d) and its slope f_s(s, d), each for arrays.

    All map numbers in [0, 1]. Arrays of different shapes are broadcast.
    """

    name: str
    blend: Callable[[Values, Values], Values]
    source: Callable[[Values, Values], Values]
    slope: Callable[[Values, Values], Values]


def _operator(name: str, blend: Callable, source: Callable) -> Operator:
    def slope(s, d):
        s, d = jnp.broadcast_arrays(s, d)
        return jax.jvp(lambda each: blend(each, d), (s,), (jnp.ones_like(s),))[1]

    compiled = (jax.jit(each) for each in (blend, source, slope))
    return Operator(name, *(_in_numpy(each) for each in compiled))


def _in_numpy(compiled: Callable) -> Callable[[Values, Values], Values]:
    return lambda first, detail: np.asarray(compiled(first, detail))


OPERATORS: dict[str, Operator] = {
    each.name: each
    for each in (
        _operator("overlay", detail.overlay, detail.overlay_source),
        _operator("smooth-overlay", detail.smooth_overlay, detail.smooth_overlay_source),
        _operator("symmetric-overlay", detail.symmetric_overlay, detail.symmetric_overlay_source),
    )
}


def operator(name: str) -> Operator:
    """Return the operator with a name. Raises ValueError if there is none."""
    if name not in OPERATORS:
        raise ValueError(f"operator {name} is unknown: allowed are {', '.join(OPERATORS)}")
    return OPERATORS[name]
