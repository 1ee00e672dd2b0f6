"""A quantity with its axes and the independent methods ("legs") that give its exact values."""

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, Device

from integrals.batches import in_batches
from integrals.compilation import jit_for_few_calls
from integrals.data import Data
from integrals.devices import all_devices, spread
from integrals.sampling import Sampling

# How points are distributed along an axis: evenly, evenly in the logarithm, or as the squares of
# evenly distributed numbers, which puts more points near the lower end.
Scale = Literal["linear", "logarithmic", "square"]


class Estimate(NamedTuple):
    """A value and its error: a bound on the error, or for Monte Carlo the standard error."""

    value: Array
    error: Array


Leg = Callable[..., Estimate]


@dataclass(frozen=True)
class Axis:
    """One argument of a quantity: its name, symbol, unit ('rad' or '1'), domain and meaning.

    The domain is [`lower`, `upper`], or without `lower` itself if `open_below` is true. `upper` may
    be infinite. `scale` says how points are distributed along the axis; 'logarithmic' needs
    `lower` > 0. `period` is set if the quantity is periodic in this argument. `alias` is a second,
    shorter name for the option on the command line. The symbol is by default the name.
    """

    name: str
    lower: float | int
    upper: float | int
    symbol: str = ""
    unit: str = "1"
    meaning: str = ""
    open_below: bool = False
    scale: Scale = "linear"
    period: float | None = None
    alias: str | None = None

    def __post_init__(self) -> None:
        """Take the name for a symbol that is not given; raise ValueError for an empty domain."""
        if not self.lower < self.upper:
            raise ValueError(f"{self.name} in [{self.lower:g}, {self.upper:g}]: it is empty")
        object.__setattr__(self, "symbol", self.symbol or self.name)
        object.__setattr__(self, "lower", float(self.lower))
        object.__setattr__(self, "upper", float(self.upper))

    @property
    def domain(self) -> str:
        """The domain as text, such as '(0, 1]'."""
        left = "(" if self.open_below else "["
        right = f"{self.upper:.6g}]" if math.isfinite(self.upper) else "∞)"
        return f"{left}{self.lower:.6g}, {right}"

    def contains(self, value):
        """Return, for each element of `value`, whether it lies in the domain. NaN does not."""
        above = value > self.lower if self.open_below else value >= self.lower
        return above & (value <= self.upper) & (value < math.inf)

    def check(self, value: float) -> float:
        """Return `value`, or raise ValueError if it is outside the domain."""
        if not (math.isfinite(value) and self.contains(value)):
            unit = "" if self.unit == "1" else f" {self.unit}"
            given, domain = f"{self.name} = {value:g}{unit}", f"{self.domain}{unit}"
            raise ValueError(f"{given} is outside its domain {domain}")
        return value

    def place(self, fraction: np.ndarray) -> np.ndarray:
        """Map fractions in [0, 1] to values on the axis according to its `scale`.

        0 gives `lower` and 1 gives `upper`, exactly. `upper` must be finite.
        """
        width = self.upper - self.lower
        if self.scale == "logarithmic":
            value = self.lower * (1 + width / self.lower) ** fraction
        elif self.scale == "square":
            value = self.lower + width * fraction**2
        else:
            value = self.lower + width * fraction
        # Rounding may miss the upper end by one unit in the last place, to either side.
        return np.where(fraction == 1, self.upper, np.minimum(value, self.upper))


def restricted(
    axes: tuple[Axis, ...], **domains: tuple[float | int, float | int]
) -> tuple[Axis, ...]:
    """Return axes of which some, by name, have smaller domains: `restricted(axes, alpha=(0.1, 1))`.

    Raises ValueError for a name that no axis has, and for a domain that is not part of the axis's.
    """
    names = [axis.name for axis in axes]
    for name, (lower, upper) in domains.items():
        if name not in names:
            raise ValueError(f"{name!r} is no axis: allowed are {', '.join(names)}")
        axis = axes[names.index(name)]
        if not axis.lower <= lower < upper <= axis.upper:
            raise ValueError(f"{name} in [{lower:g}, {upper:g}]: allowed is part of {axis.domain}")
    return tuple(
        axis
        if axis.name not in domains
        else replace(
            axis,
            lower=domains[axis.name][0],
            upper=domains[axis.name][1],
            open_below=axis.open_below and domains[axis.name][0] == axis.lower,
        )
        for axis in axes
    )


def box_of(axes: tuple[Axis, ...]) -> np.ndarray:
    """Return the lower and upper ends of axes as an array (axes, 2)."""
    return np.array([(axis.lower, axis.upper) for axis in axes])


@dataclass(frozen=True)
class Smooth:
    """An axis along which a quantity is analytic, in the argument or in its logarithm."""

    axis: str
    logarithmic: bool = False


# Compared and hashed by identity (eq=False): JAX takes a reference as a static argument.
@dataclass(frozen=True, eq=False)
class Reference:
    """A quantity, its axes, and the independent legs that give its exact values.

    A leg takes one scalar for each axis, in the order of the axes, and returns an `Estimate`.
    Angles are in radians. A leg that does not exist is None. Every leg returns NaN outside the
    domain and where the quantity has no limit (G at d = ν = 0).

    `sampling` says how many points forms are fitted on, checked at and judged by. `batch` is the
    number of points that `estimates` evaluates at once. `options_at` takes points (n, axes) and
    returns keyword arguments of the best leg, such as the number of quadrature nodes needed there.
    `proof_options` are arguments for proofs, which need few but more exact values.
    `codomain` is the interval that contains all exact values; proofs of range hold forms to it.
    `smooth_along` has the axes along which many values may be interpolated
    (`integrals.along_lines`). `many` takes points (n, axes) of the domain and
    returns the values of another rule, with errors, that is faster than the best leg; None: there
    is none. Only `integrals.many_points` uses these two. `few_calls` says that compiling the best
    leg takes longer than evaluating it in a fit, so that fewer optimisations are better.

    A quantity that is only known by its `data` has no leg: it has values at the data's own points.
    A quantity that is only known by a table has neither legs nor data.
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
    proof_options: Mapping[str, Any] = field(default_factory=dict)
    codomain: tuple[float | int, float | int] = (0.0, 1.0)
    data: Data | None = None
    smooth_along: tuple[Smooth, ...] = ()
    many: Callable[[Array], Estimate] | None = None
    few_calls: bool = False

    @property
    def legs(self) -> dict[str, Leg]:
        """The legs that exist, by name, with the most exact one first."""
        every = {
            "closed_form": self.closed_form,
            "quadrature": self.quadrature,
            "monte_carlo": self.monte_carlo,
        }
        return {name: leg for name, leg in every.items() if leg is not None}

    @property
    def best_leg(self) -> str:
        """The name of the most exact leg. Raises ValueError if there is no leg."""
        for name in self.legs:
            return name
        if self.data:
            raise ValueError(f"{self.name} is known at the points of its data only")
        raise ValueError(f"the exact values of {self.name} are not known: load its problem (-p)")

    @property
    def compared_with(self) -> str:
        """What the errors of forms are measured against, for texts."""
        if self.data is not None:
            return "the data's own points"
        return "the integral" if self.quadrature or self.monte_carlo else "the exact values"

    def value(self, *arguments) -> Array:
        """Evaluate the most exact leg at one point."""
        return self.legs[self.best_leg](*arguments).value

    def estimates(self, points: np.ndarray, for_proof: bool = False) -> Estimate:
        """Evaluate the most exact leg at points (n, axes). Returns values and errors, (n,) each.

        `for_proof` asks for smaller errors, which may take longer.
        """
        more = self.proof_options if for_proof else {}
        options = tuple({**self.options_at(points), **more}.items())
        devices = all_devices()
        compiled = _estimates_in_few_calls if self.few_calls else _estimates_in_many_calls
        evaluate = functools.partial(compiled, self, options, devices)
        return in_batches(evaluate, points, self.batch * len(devices))

    def values(self, points: np.ndarray) -> np.ndarray:
        """Evaluate the most exact leg at points (n, axes). Returns the values (n,)."""
        return np.asarray(self.estimates(points).value)


def _estimates(
    reference: Reference,
    options: tuple[tuple[str, Any], ...],
    devices: tuple[Device, ...],
    points: Array,
) -> Estimate:
    leg = reference.legs[reference.best_leg]
    return spread(jax.vmap(lambda x: leg(*x, **dict(options))), devices)(points)


_estimates_in_few_calls = jit_for_few_calls(_estimates, static=(0, 1, 2))
_estimates_in_many_calls = jax.jit(_estimates, static_argnums=(0, 1, 2))


def leg(*axes: Axis) -> Callable[[Leg], Leg]:
    """Return a decorator that makes a function of the axes' values a leg.

    The leg raises RuntimeError without float64, raises ValueError for a wrong number of arguments,
    and returns NaN outside the domain.
    """

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
