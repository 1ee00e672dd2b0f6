"""Lookup tables (LUTs): values at the texels of a texture, and how a GPU filters between them."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from coefficients.lut.texels import Texel, decoded
from integrals.reference import Axis

Filter = Literal["linear", "cubic"]
Centres = Literal["ends", "half"]

# NVIDIA's hardware filters with weights of 8 fractional bits (CUDA C++ Programming Guide, "Linear
# Filtering").
WEIGHT_BITS = 8
# Catmull–Rom weights of one axis: the place in the texel (2), and its four weights (16).
_CUBIC_AXIS = 18
# Texels are filtered for so many points at once.
_BATCH = 1 << 16


@dataclass(frozen=True)
class Coordinate:
    """A texture coordinate u = factor · f(x − shift) + offset of an axis's value x.

    `function` is the name of f: '' for none, 'log' or 'sqrt'.
    """

    factor: float
    offset: float
    function: str = ""
    shift: float = 0.0

    @property
    def operations(self) -> int:
        """The number of operations."""
        parts = (self.factor != 1, self.offset != 0, self.function != "", self.shift != 0)
        return sum(parts)

    def at(self, values: np.ndarray) -> np.ndarray:
        """Return the coordinates of values on the axis."""
        known = {"": lambda x: x, "log": np.log, "sqrt": np.sqrt}
        return self.factor * known[self.function](values - self.shift) + self.offset

    def text(self, symbol: str) -> str:
        """Write the formula for an axis that is called `symbol`."""
        inner = symbol if self.shift == 0 else f"{symbol} {_signed(-self.shift)}"
        if self.function:
            inner = f"{self.function}({inner})"
        scaled = inner if self.factor == 1 else f"{self.factor:.9g} {inner}"
        return scaled if self.offset == 0 else f"{scaled} {_signed(self.offset)}"


@dataclass(frozen=True, eq=False)
class Lut:
    """A texture that stands for a quantity, with the convention by which it is sampled.

    * `stored` (n₁, …): the texels as they are stored, one dimension for each of the `axes`. A
      texture's width is that of the first axis, its height that of the second.
    * `texel`: their type. `span`: the values that the texels 0 and 1 stand for; (0, 1) for floats.
    * `centres`: 'ends' puts the centres of the first and last texels at the ends of an axis. A
      shader computes the texture coordinate u = (½ + t (n − 1))/n from the place t in [0, 1] on the
      axis (`coordinates`). 'half' takes u = t: the centres are half a texel from the ends, and the
      value is constant beyond them. t follows the `scale` of the axis.
    * `filter`: 'linear' is the filter of the hardware, with one fetch. Its coordinates are rounded
      to 1/2^`weight_bits` of a texel; None leaves them exact. 'cubic' is a Catmull–Rom spline,
      which a shader computes from four texels an axis, in full precision. Both clamp to the edge.
      A cubic LUT with 'ends' has a border of one texel, outside of the domain, which continues the
      values as parabolas; its u is (1½ + t (n − 3))/n.
    * `moved`: the number of texels at which the quantity has no value. They have the value at a
      point a tenth of a texel further in.
    * `rounding`: the largest difference of a texel from the value that it was rounded from.
    """

    axes: tuple[Axis, ...]
    stored: np.ndarray
    texel: Texel = "float32"
    span: tuple[float, float] = (0.0, 1.0)
    filter: Filter = "linear"
    centres: Centres = "ends"
    weight_bits: int | None = WEIGHT_BITS
    moved: int = 0
    rounding: float = 0.0

    @property
    def size(self) -> tuple[int, ...]:
        """The number of texels along each axis."""
        return self.stored.shape

    @property
    def border(self) -> int:
        """The number of texels outside of the domain at each end of an axis, 0 or 1."""
        return border_of(self.filter, self.centres)

    @property
    def bytes(self) -> int:
        """The number of bytes of all texels."""
        return self.stored.nbytes

    @property
    def fetches(self) -> int:
        """The number of texture fetches of a lookup."""
        return 1 if self.filter == "linear" else 4 ** len(self.axes)

    @property
    def operations(self) -> int:
        """The number of operations of a lookup besides its fetches.

        They are those of the texture coordinates, and of a shader's own filter.
        """
        count = sum(each.operations for each in self.coordinates)
        if self.span != (0.0, 1.0):
            count += 2
        if self.filter == "cubic":
            # A sum of four products takes 7 operations. There are 4^(k − 1) of them for axis k.
            sums = sum(4**k for k in range(len(self.axes)))
            count += _CUBIC_AXIS * len(self.axes) + 7 * sums
        return count

    @property
    def coordinates(self) -> "tuple[Coordinate, ...]":
        """The texture coordinate of each axis, as a shader computes it."""
        sides = zip(self.axes, self.size, strict=True)
        return tuple(_coordinate(axis, n, self.border, self.centres) for axis, n in sides)

    @property
    def texels(self) -> np.ndarray:
        """The values (n₁, …) that the texels stand for, in float64."""
        return decoded(self.stored, self.span)

    @property
    def points(self) -> np.ndarray:
        """The centres of the texels, as points (n, axes) in the order of the stored texels.

        Those of a border are nan.
        """
        inner = [n - 2 * self.border for n in self.size]
        points = points_at(self.axes, texel_centres(inner, self.centres))
        edges = [(self.border, self.border)] * len(inner) + [(0, 0)]
        grid = np.pad(points.reshape(*inner, len(inner)), edges, constant_values=np.nan)
        return grid.reshape(-1, len(inner))

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Return the filtered values (n,) at points (n, axes)."""
        parts = [
            self._filtered(points[first : first + _BATCH])
            for first in range(0, len(points), _BATCH)
        ]
        return np.concatenate(parts) if parts else np.zeros(0)

    def _filtered(self, points: np.ndarray) -> np.ndarray:
        texels = self.texels
        corners = []
        for k, axis in enumerate(self.axes):
            count = self.size[k]
            t = np.clip(fraction_on(axis, points[:, k]), 0, 1)
            last = count - 1 - 2 * self.border
            place = self.border + t * last if self.centres == "ends" else t * count - 0.5
            if self.filter == "linear" and self.weight_bits is not None:
                place = np.round(place * 2**self.weight_bits) / 2**self.weight_bits
            first = np.floor(place).astype(int)
            weights = _WEIGHTS[self.filter](place - first)
            start = 0 if self.filter == "linear" else -1
            corners.append(
                [(np.clip(first + start + j, 0, count - 1), w) for j, w in enumerate(weights)]
            )
        total = np.zeros(len(points))
        for chosen in itertools.product(*corners):
            weight = math.prod((w for _, w in chosen), start=np.ones(len(points)))
            total += weight * texels[tuple(index for index, _ in chosen)]
        return total


def border_of(filter: Filter, centres: Centres) -> int:
    """Return the number of texels outside of the domain at each end of an axis."""
    return int(filter == "cubic" and centres == "ends")


def texel_centres(size: Sequence[int], centres: Centres) -> np.ndarray:
    """Return the places (n, axes) in [0, 1] of the centres of texels; the last axis is fastest."""
    ends = centres == "ends"
    lines = [np.linspace(0, 1, n) if ends else (np.arange(n) + 0.5) / n for n in size]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(size))


def fraction_on(axis: Axis, values: np.ndarray) -> np.ndarray:
    """Map values (…) on an axis to fractions (…) in [0, 1]: the inverse of `Axis.place`."""
    width = axis.upper - axis.lower
    if axis.scale == "logarithmic":
        return np.log(values / axis.lower) / np.log(axis.upper / axis.lower)
    fraction = (values - axis.lower) / width
    return np.sqrt(np.maximum(fraction, 0)) if axis.scale == "square" else fraction


def points_at(axes: Sequence[Axis], unit: np.ndarray) -> np.ndarray:
    """Map places (n, axes) in [0, 1] on the axes to points (n, axes)."""
    return np.stack([axis.place(unit[:, k]) for k, axis in enumerate(axes)], axis=1)


def _signed(number: float) -> str:
    return f"{'-' if number < 0 else '+'} {abs(number):.9g}"


def _coordinate(axis: Axis, count: int, border: int, centres: Centres) -> Coordinate:
    # u = a t + b, where t is the place on the axis in [0, 1].
    a, b = 1.0, 0.0
    if centres == "ends":
        a, b = (count - 1 - 2 * border) / count, (0.5 + border) / count
    width = axis.upper - axis.lower
    if axis.scale == "logarithmic":
        factor = a / math.log(axis.upper / axis.lower)
        return Coordinate(factor, b - factor * math.log(axis.lower), "log")
    if axis.scale == "square":
        return Coordinate(a / math.sqrt(width), b, "sqrt", axis.lower)
    return Coordinate(a / width, b - a / width * axis.lower)


def _linear(f: np.ndarray) -> tuple[np.ndarray, ...]:
    return 1 - f, f


def _catmull_rom(f: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the weights of four texels, with the place between the second and the third."""
    first = f * (-0.5 + f * (1 - 0.5 * f))
    second = 1 + f * f * (1.5 * f - 2.5)
    fourth = f * f * (0.5 * f - 0.5)
    return first, second, 1 - first - second - fourth, fourth


_WEIGHTS = {"linear": _linear, "cubic": _catmull_rom}
