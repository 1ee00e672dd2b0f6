"""Ranges of integration, finite or not, as maps from [0, 1]."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

# The end of a range or a break: a number, or a function of the axes' values.
Place = int | float | Callable


class Range(NamedTuple):
    """A range of one variable of integration, and the breaks in it.

    An end that is a function has to be finite. An infinite end is given as a number: [a, ∞) is
    t = a + u/(1 − u), (−∞, b] is t = b − (1 − u)/u, and the whole line is t = s/(1 − s²) with
    s = 2u − 1. If the upper end is a function that falls below the lower end, the integral gets a
    negative sign, as usual.
    """

    lower: Place
    upper: Place
    breaks: tuple[Place, ...]

    @property
    def infinite(self) -> tuple[bool, bool]:
        """Whether the lower and the upper end are infinite."""
        return _is_infinite(self.lower), _is_infinite(self.upper)

    def place(self, u: Array, axes: tuple[Array, ...]) -> tuple[Array, Array]:
        """Return the variable t at u in [0, 1], and dt/du."""
        below, above = self.infinite
        if below and above:
            s = 2 * u - 1
            # 1 − s² without cancellation.
            rest = 4 * u * (1 - u)
            return s / rest, 2 * (1 + s * s) / (rest * rest)
        if above:
            return at(self.lower, axes) + u / (1 - u), 1 / (1 - u) ** 2
        if below:
            return at(self.upper, axes) - (1 - u) / u, 1 / u**2
        lower, upper = at(self.lower, axes), at(self.upper, axes)
        return lower + (upper - lower) * u, upper - lower

    def edges(self, axes: tuple[Array, ...]) -> Array:
        """Return 0, the breaks and 1 in the coordinate u, increasing: (breaks + 2,).

        A break outside the range counts as its nearest end.
        """
        places = [self._coordinate(at(each, axes), axes) for each in self.breaks]
        inside = [jnp.clip(u, 0.0, 1.0) for u in places]
        return jnp.concatenate([jnp.zeros(1), jnp.sort(jnp.array(inside)), jnp.ones(1)])

    def _coordinate(self, t: Array, axes: tuple[Array, ...]) -> Array:
        below, above = self.infinite
        if below and above:
            return (1 + 2 * t / (1 + jnp.sqrt(1 + 4 * t * t))) / 2
        if above:
            distance = jnp.maximum(t - at(self.lower, axes), 0.0)
            return distance / (1 + distance)
        if below:
            return 1 / (1 + jnp.maximum(at(self.upper, axes) - t, 0.0))
        lower, upper = at(self.lower, axes), at(self.upper, axes)
        length = upper - lower
        return jnp.where(length == 0, 0.0, (t - lower) / jnp.where(length == 0, 1.0, length))


def _is_infinite(end: Place) -> bool:
    return not callable(end) and math.isinf(end)


def ranges_of(over: Sequence, breaks: Sequence) -> list[Range]:
    """Return the ranges with these ends (lower, upper), and for each a sequence of breaks.

    With one range, `breaks` may be the sequence itself, and without breaks it may be empty. Raises
    ValueError for other lengths, for an empty range, and for ends or breaks that are NaN.
    """
    if not all(isinstance(pair, Sequence) and len(pair) == 2 for pair in over):
        raise ValueError(f"over = {over!r}: expected is (lower, upper) for each variable")
    flat = not any(isinstance(each, Sequence) for each in breaks)
    if flat:
        breaks = [tuple(breaks), *[()] * (len(over) - 1)] if len(over) == 1 or not breaks else []
    if len(breaks) != len(over):
        raise ValueError(f"breaks: expected is one sequence for each of the {len(over)} variables")
    ranges = []
    for lower, upper in over:
        if not (callable(lower) or callable(upper) or lower < upper):
            raise ValueError(f"over ({lower}, {upper}): the interval is empty")
        if lower == math.inf or upper == -math.inf:
            raise ValueError(f"over ({lower}, {upper}): the interval is empty")
        inside = tuple(breaks[len(ranges)])
        if any(not callable(each) and not math.isfinite(each) for each in inside):
            raise ValueError(f"breaks = {inside}: they have to be finite")
        ranges.append(Range(lower, upper, inside))
    return ranges


def at(place: Place, axes: tuple[Array, ...]) -> Array:
    """Return a place as a float64 scalar, at the given values of the axes."""
    return jnp.asarray(place(*axes) if callable(place) else place, dtype=float)
