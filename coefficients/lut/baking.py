"""Making LUTs of functions, and measuring their errors."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from coefficients.lut.texels import Texel, decoded, encoded
from coefficients.lut.texture import (
    WEIGHT_BITS,
    Centres,
    Filter,
    Lut,
    border_of,
    points_at,
    texel_centres,
)
from fitting.errors import Errors, judge_values
from fitting.points.domain import Domain
from integrals.reference import Axis, Reference

MOST_AXES = 3
# Values at more texels would not fit into memory at once.
MOST_TEXELS = 1 << 24
# A texel at which the quantity has no value takes the value at this part of a texel further in.
_INWARD = 0.1


def bake(
    values_at: Callable[[np.ndarray], np.ndarray],
    axes: Sequence[Axis],
    size: Sequence[int],
    filter: Filter = "linear",
    texel: Texel = "float32",
    centres: Centres = "ends",
    weight_bits: int | None = WEIGHT_BITS,
) -> Lut:
    """Return a LUT of a quantity or a form.

    Arguments: `values_at`, a function from points (n, axes) to values (n,); `axes`, one to three,
    with finite domains; `size`, the number of texels along each axis, at least 2, or 5 if there is
    a border. The rest is as in `Lut`. Values that are not all in [0, 1] give texels of an unorm
    type a wider `span`. Raises ValueError for what is not allowed, for values that are not finite,
    and for values that are too large for the texels.
    """
    axes = tuple(axes)
    border = border_of(filter, centres)
    _require(axes, size, 2 + 3 * border)
    inner = [n - 2 * border for n in size]
    unit = texel_centres(inner, centres)
    values = np.array(values_at(points_at(axes, unit)), float)
    lost = ~np.isfinite(values)
    if lost.any():
        step = _INWARD / np.array(inner)
        inward = np.clip(unit[lost], step, 1 - step)
        values[lost] = values_at(points_at(axes, inward))
    for index in np.flatnonzero(~np.isfinite(values)):
        (point,) = points_at(axes, unit[index : index + 1])
        place = ", ".join(f"{axis.name} = {x:.6g}" for axis, x in zip(axes, point, strict=True))
        raise ValueError(f"no value at {place}: a LUT needs values on its whole domain")
    grid = values.reshape(inner)
    grid = _with_border(grid) if border else grid
    stored, span = encoded(grid, texel)
    rounding = float(np.abs(decoded(stored, span) - grid).max())
    moved = int(lost.sum())
    return Lut(axes, stored, texel, span, filter, centres, weight_bits, moved, rounding)


def errors_of(lut: Lut, reference: Reference, axes: tuple[Axis, ...] | None = None) -> Errors:
    """Return the errors of a LUT against exact values, at the points that judge a form.

    `axes` restricts the domain; None stands for that of the LUT.
    """
    return judge_values(lut, Domain(reference, lut.axes if axes is None else axes))


def scaled_for_lut(axes: Sequence[Axis]) -> tuple[Axis, ...]:
    """Return axes with the scales of a LUT: linear where a logarithmic axis begins at 0."""
    return tuple(
        replace(axis, scale="linear") if axis.scale == "logarithmic" and axis.lower <= 0 else axis
        for axis in axes
    )


def _with_border(grid: np.ndarray) -> np.ndarray:
    """Add a texel at each end of every axis, on the parabola through the three next to it."""
    for k in range(grid.ndim):
        rows = np.moveaxis(grid, k, 0)
        ends = [3 * a - 3 * b + c for a, b, c in (rows[:3], rows[:-4:-1])]
        grid = np.moveaxis(np.concatenate([ends[:1], rows, ends[1:]]), 0, k)
    return grid


def _require(axes: tuple[Axis, ...], size: Sequence[int], least: int) -> None:
    if not 1 <= len(axes) <= MOST_AXES:
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(f"{len(axes)} axes ({names}): a texture has at most {MOST_AXES}")
    if len(size) != len(axes):
        names = ", ".join(axis.name for axis in axes)
        shown = "x".join(map(str, size))
        raise ValueError(f"size {shown}: expected are {len(axes)} numbers, for {names}")
    if min(size) < least or math.prod(size) > MOST_TEXELS:
        shown = "x".join(map(str, size))
        raise ValueError(f"size {shown}: allowed are {least} or more an axis, {MOST_TEXELS} in all")
    for axis in axes:
        if not math.isfinite(axis.upper - axis.lower):
            raise ValueError(f"{axis.name} in {axis.domain}: a LUT needs a finite domain")
        if axis.scale == "logarithmic" and axis.lower <= 0:
            raise ValueError(f"{axis.name} in {axis.domain}: a logarithmic axis begins above 0")
