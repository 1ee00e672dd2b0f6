"""Operators that put a detail onto a source, and their inverses, as functions to export.

Each is declared as a quantity with a closed form, as a sampler is. It has no forms, and no command
but those for code knows it.
"""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from programs.functions import Function, Parameter, function
from quantities.calling_convention import CallingConvention, clamped
from quantities.problem import ExactCode, Problem
from shading.detail.inverses import (
    LEAST,
    STEPS,
    STEPS_FLOAT,
    overlay_root,
    smooth_overlay_root,
    symmetric_overlay_root,
)
from shading.detail.operators import overlay, smooth_overlay, symmetric_overlay

# The absolute error of the closed forms in float64: some roundings
_ROUNDING = 1e-14
# The smallest number of the type "half" that is not subnormal
_LEAST_HALF = 2.0**-14
_NAMES = ("overlay", "smooth-overlay", "symmetric-overlay")
_BLENDS = dict(zip(_NAMES, (overlay, smooth_overlay, symmetric_overlay), strict=True))
_ROOTS = {"smooth-overlay": smooth_overlay_root, "symmetric-overlay": symmetric_overlay_root}
_DETAIL = Axis("detail", 0.0, 1.0, "d", meaning="detail")


def _source(name: str, target: Array, detail: Array, precision: str) -> Array:
    if name == "overlay":
        return overlay_root(target, detail)
    steps = STEPS if precision == "double" else STEPS_FLOAT
    return _ROOTS[name](target, detail, steps, _LEAST_HALF if precision == "half" else LEAST)


def _blend(name: str, source: Array, detail: Array, _: str) -> Array:
    return _BLENDS[name](source, detail)


def _function(name: str, first: str, call: Callable, summary: str, precision: str) -> Function:
    def operator(value, detail):
        return call(clamped(value, 0.0, 1.0), clamped(detail, 0.0, 1.0), precision)

    parameters = [Parameter(first, (0.0, 1.0)), Parameter("detail", (0.0, 1.0))]
    return function(name, parameters, operator, summary)


def _operator(name: str, inverse: bool) -> Problem:
    # "target" is a reserved word of WGSL.
    first, symbol = ("wanted", "t") if inverse else ("source", "s")
    axes = (Axis(first, 0.0, 1.0, symbol, meaning="target" if inverse else first), _DETAIL)

    def call(value, detail, precision):
        return (_source if inverse else _blend)(name, value, detail, precision)

    @leg(*axes)
    def closed_form(*point):
        return Estimate(call(*point, "double"), jnp.asarray(_ROUNDING))

    word = "Detail" + "".join(part.capitalize() for part in name.split("-"))
    if inverse:
        key, symbol = f"{name}-inverse", "s(t, d)"
        meaning = f"the source that {name} with a detail turns into a target"
        summary = f"The source s with {word}(s, detail) = wanted."
        equation, code = "f(s, d) = t, solved for s", f"{word}Inverse"
    else:
        key, symbol = name, "f(s, d)"
        meaning = f"a detail put onto a source by {name}"
        summary, equation, code = "The detail put onto the source.", "f(s, d)", word
    reference = Reference(
        key, symbol, meaning, equation, axes, Sampling(10, 10, 10), closed_form=closed_form
    )
    exact = ExactCode(
        "closed form",
        axes,
        lambda precision: (_function(code, first, call, summary, precision),),
        lambda points: (np.asarray(points),),
        "The arguments may be any numbers: they are clamped to [0, 1], where the result is, too",
    )
    return Problem(reference, (), CallingConvention(key, "", ()), exact_code=exact)


# By name; an operator and its inverse follow each other.
OPERATORS: dict[str, Problem] = {
    each.name: each
    for name in _NAMES
    for each in (_operator(name, inverse=False), _operator(name, inverse=True))
}
