"""What an integral is: named axes with their domain, and legs that evaluate it independently."""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array


class Estimate(NamedTuple):
    """A value with a bound on its error, or, from Monte Carlo, with its standard error."""

    value: Array
    error: Array


Leg = Callable[..., Estimate]


@dataclass(frozen=True)
class Axis:
    """One argument of an integral: its name, symbol, unit ('rad' or '1') and domain."""

    name: str
    symbol: str
    unit: str
    lower: float
    upper: float
    meaning: str
    open_below: bool = False

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


@dataclass(frozen=True)
class Integral:
    """A named quantity, its axes, and the independent legs that give its exact value.

    Each leg takes the axes' values in order, scalars in radians where the unit is so, and gives
    an `Estimate`; a leg that does not exist is None. Every leg gives NaN outside the domain, and
    where the integral has no limit (G at d = ν = 0).
    """

    name: str
    symbol: str
    meaning: str
    definition: str
    axes: tuple[Axis, ...]
    closed_form: Leg | None = None
    quadrature: Leg | None = None
    monte_carlo: Leg | None = None

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
    def reference(self) -> str:
        """The name of the most exact leg."""
        return next(iter(self.legs))

    def value(self, *arguments) -> Array:
        """Evaluate the reference leg at one point."""
        return self.legs[self.reference](*arguments).value


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
