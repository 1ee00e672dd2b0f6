"""The exact values of a quantity: its axes, and independent methods ("legs") that evaluate it."""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.sampling import Sampling

# How points are spread along an axis: evenly; evenly in the logarithm; or as u², u in [0, 1],
# which puts more of them near the lower end.
Scale = Literal["linear", "logarithmic", "square"]


class Estimate(NamedTuple):
    """A value with a bound on its error, or, from Monte Carlo, with its standard error."""

    value: Array
    error: Array


Leg = Callable[..., Estimate]


@dataclass(frozen=True)
class Axis:
    """One argument of a quantity: its name, symbol, unit ('rad' or '1') and domain.

    `scale` says how points are spread along it. `period` is set for an angle that goes all the way
    round. `alias` is a second, shorter name of the command line's option.
    """

    name: str
    symbol: str
    unit: str
    lower: float
    upper: float
    meaning: str
    open_below: bool = False
    scale: Scale = "linear"
    period: float | None = None
    alias: str | None = None

    @property
    def domain(self) -> str:
        """The domain as text, such as '(0, 1]'."""
        left = "(" if self.open_below else "["
        right = f"{self.upper:.6g}]" if math.isfinite(self.upper) else "∞)"
        return f"{left}{self.lower:.6g}, {right}"

    def contains(self, value):
        """Tell, elementwise, whether `value` lies in the domain; NaN does not."""
        above = value > self.lower if self.open_below else value >= self.lower
        return above & (value <= self.upper) & (value < math.inf)

    def check(self, value: float) -> float:
        """Return `value`; raise ValueError if it is not in the domain."""
        if not (math.isfinite(value) and self.contains(value)):
            unit = "" if self.unit == "1" else f" {self.unit}"
            given, domain = f"{self.name} = {value:g}{unit}", f"{self.domain}{unit}"
            raise ValueError(f"{given} is outside its domain {domain}")
        return value

    def place(self, fraction: np.ndarray) -> np.ndarray:
        """Map fractions in [0, 1] of the axis to values, by its scale."""
        width = self.upper - self.lower
        if self.scale == "logarithmic":
            return self.lower * (1 + width / self.lower) ** fraction
        if self.scale == "square":
            fraction = fraction**2
        return self.lower + width * fraction


def box_of(axes: tuple[Axis, ...]) -> np.ndarray:
    """Give the lower and upper ends of axes, shape (axes, 2)."""
    return np.array([(axis.lower, axis.upper) for axis in axes])


@dataclass(frozen=True, eq=False)
class Reference:
    """A quantity's exact values: its axes, and the independent legs that evaluate it.

    Each leg takes the axes' values in order, scalars in radians where the unit is so, and gives
    an `Estimate`; a leg that does not exist is None. Every leg gives NaN outside the domain, and
    where the quantity has no limit (G at d = ν = 0).

    `sampling` says at how many points forms are fitted, checked and judged. `batch` points are
    evaluated at once. `options_at` gives, for points (n, axes), further arguments of the best leg,
    such as how many nodes a quadrature rule needs there.
    """

    name: str
    symbol: str
    meaning: str
    definition: str
    axes: tuple[Axis, ...]
    sampling: Sampling
    closed_form: Leg | None = None
    quadrature: Leg | None = None
    monte_carlo: Leg | None = None
    batch: int = 8192
    options_at: Callable[[np.ndarray], dict[str, Any]] = lambda _: {}

    @property
    def legs(self) -> dict[str, Leg]:
        """The legs that exist, by name, the most exact first."""
        every = {
            "closed_form": self.closed_form,
            "quadrature": self.quadrature,
            "monte_carlo": self.monte_carlo,
        }
        return {name: leg for name, leg in every.items() if leg is not None}

    @property
    def best_leg(self) -> str:
        """The name of the most exact leg."""
        return next(iter(self.legs))

    def value(self, *arguments) -> Array:
        """Evaluate the most exact leg at one point."""
        return self.legs[self.best_leg](*arguments).value

    def estimates(self, points: np.ndarray) -> Estimate:
        """Evaluate the most exact leg at points (n, axes): values and errors, (n,) each."""
        options = tuple(self.options_at(points).items())
        return in_batches(functools.partial(_estimates, self, options), points, self.batch)

    def values(self, points: np.ndarray) -> np.ndarray:
        """Evaluate the most exact leg at points (n, axes): (n,)."""
        return np.asarray(self.estimates(points).value)


@functools.partial(jax.jit, static_argnums=(0, 1))
def _estimates(reference: Reference, options: tuple[tuple[str, Any], ...], points) -> Estimate:
    leg = reference.legs[reference.best_leg]
    return jax.vmap(lambda x: leg(*x, **dict(options)))(points)


def in_batches(function: Callable, points: np.ndarray, batch: int):
    """Apply a function of points (batch, axes) to points (n, axes), so that it is compiled once.

    The last batch is filled up with its last point. Returns what the function returns, (n, …).
    """
    count = len(points)
    padded = np.concatenate([points, np.repeat(points[-1:], -count % batch, axis=0)])
    parts = [function(padded[first : first + batch]) for first in range(0, count, batch)]
    return jax.tree.map(lambda *each: jnp.asarray(np.concatenate(each)[:count]), *parts)


def leg(*axes: Axis) -> Callable[[Leg], Leg]:
    """Make a function of the axes' values a leg: float64 only, and NaN outside the domain."""

    def decorate(function: Leg) -> Leg:
        @functools.wraps(function)
        def checked(*arguments, **options) -> Estimate:
            require_float64()
            if len(arguments) != len(axes):
                names = ", ".join(axis.name for axis in axes)
                raise ValueError(f"{len(arguments)} arguments given, expected {names}")
            values = [jnp.asarray(argument, dtype=float) for argument in arguments]
            estimate = function(*values, **options)
            inside = functools.reduce(
                jnp.logical_and, (axis.contains(v) for axis, v in zip(axes, values, strict=True))
            )
            return Estimate(
                jnp.where(inside, estimate.value, jnp.nan),
                jnp.where(inside, estimate.error, jnp.nan),
            )

        return checked

    return decorate


def require_float64() -> None:
    """Raise RuntimeError unless JAX computes in float64."""
    if not jax.config.read("jax_enable_x64"):
        raise RuntimeError(
            "the references need float64: call jax.config.update('jax_enable_x64', True) first"
        )
