"""References for a quantity of your own: a closed form, an integral, or an average of samples.

A `Source` says how a quantity is evaluated. `make_reference` joins it with the axes:

    F_avg = make_reference(
        quadrature(lambda t, eta: 4 * t**3 * reflectance(t * t, eta), over=[(0, 1)]),
        name="fresnel", axes=(ETA,), symbol="F_avg", definition="2 ∫ F(μ, η) μ dμ",
        meaning="average reflectance",
    )

Sources are added to give a reference with several independent legs: `closed_form(f) +
quadrature(g, over=[(0, 1)])`. All functions are written with jax.numpy and take scalars: first the
variables of integration, then the axes. Every leg works under `jax.jit` and `jax.vmap`. Closed form
and quadrature also work under `jax.grad`, by the axes.
"""

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.monte_carlo import Sequence as PointSequence
from integrals.monte_carlo import mean_estimate, unit_points
from integrals.reference import Axis, Estimate, Leg, leg
from integrals.rules.adaptive import adaptive
from integrals.rules.directions import hemisphere_angles, sphere_angles
from integrals.rules.effort import Effort, effort_of, evaluations_at_once
from integrals.rules.ranges import Place, Range, at, ranges_of
from integrals.user_functions import check_function, check_map, check_range, probe_cube

# The error of a closed form without a stated error, in units of ε times its value.
ROUNDINGS = 8

_ORDER = ("closed_form", "quadrature", "monte_carlo")


@dataclass(frozen=True, eq=False)
class Source:
    """Independent methods for one quantity, without its axes.

    `builders` has for each leg's name a function from the axes to the leg. `at_once` is the number
    of values of the integrand that a leg needs in memory for one point. `function` is that of the
    closed form, if there is one.
    """

    builders: Mapping[str, Callable[[tuple[Axis, ...]], Leg]]
    at_once: Mapping[str, int]
    function: Callable | None = None

    def legs(self, axes: Sequence[Axis]) -> dict[str, Leg]:
        """Return the legs by name: 'closed_form', 'quadrature', 'monte_carlo', if they exist.

        Raises ValueError if a function takes other arguments, or is NaN at a point that is tried.
        """
        names = [name for name in _ORDER if name in self.builders]
        return {name: self.builders[name](tuple(axes)) for name in names}

    def __add__(self, other: "Source") -> "Source":
        """Return a source with the legs of both. Raises ValueError if they have one in common."""
        if not isinstance(other, Source):
            return NotImplemented
        for name in self.builders.keys() & other.builders.keys():
            raise ValueError(f"two sources have a leg {name}: allowed is one of each")
        return Source(
            {**self.builders, **other.builders},
            {**self.at_once, **other.at_once},
            self.function or other.function,
        )


def closed_form(function: Callable, error: Place | None = None) -> Source:
    """Return a source of `function(*axes)`.

    `error` bounds the absolute error: a number, or a function of the axes. Without it, the error is
    8ε of the value, with ε of float64. That is the rounding of a few operations, if none cancels.
    """

    def build(axes: tuple[Axis, ...]) -> Leg:
        check_function(function, [], [], axes)
        if callable(error):
            check_function(error, [], [], axes)

        def evaluate(*values) -> Estimate:
            value = jnp.asarray(function(*values), dtype=float)
            if error is None:
                return Estimate(value, ROUNDINGS * np.finfo(float).eps * jnp.abs(value))
            return Estimate(value, jnp.broadcast_to(at(error, values), value.shape))

        return leg(*axes)(evaluate)

    return Source({"closed_form": build}, {"closed_form": 1}, function)


def quadrature(
    integrand: Callable,
    over: Sequence,
    *,
    breaks: Sequence = (),
    nodes: int | None = None,
    panels: int | None = None,
    steps: int | None = None,
    tolerance: int | float | None = None,
) -> Source:
    """Return a source of ∫ `integrand(t1, …, tk, *axes)` over a box, for one to four variables.

    `over` has the ends of each variable: numbers, which may be infinite, or functions of the axes.
    `breaks` has, for each variable, the places where the integrand has a kink or a jump: numbers or
    functions of the axes. With one variable, these need not be wrapped: `breaks=(0.5,)`. A jump
    that moves with an axis needs a break, or else the derivative by this axis misses it.

    The rule is adaptive (`rules.adaptive`). The stated error is large where the rule does not
    resolve the integrand. It does not include the rounding of the integrand itself. A peak that is
    narrower than the distance of the first nodes is not found: this is about 1/80 of a range in one
    variable with the default 16 `nodes` and 8 `panels`, so a Gaussian of standard deviation 1e-3
    is found. A higher number of `panels` or a break at the peak finds narrower ones.

    `nodes` are those of a panel in each variable. Up to `steps` times, the worst panels are halved,
    until the error is below `tolerance` times ∫ |integrand|. The defaults are in
    `rules.effort.DEFAULTS`.
    """
    ranges = ranges_of(over, breaks)
    effort = effort_of(len(ranges), nodes=nodes, panels=panels, steps=steps, tolerance=tolerance)
    names = [f"t{j + 1}" for j in range(len(ranges))] if len(ranges) > 1 else ["t"]

    def build(axes: tuple[Axis, ...]) -> Leg:
        fractions = probe_cube(len(ranges))
        variables = [check_range(*pair, axes) for pair in zip(ranges, fractions, strict=True)]
        check_function(integrand, names, variables, axes)

        def weighted(u, *values):
            pairs = [each.place(u[j], values) for j, each in enumerate(ranges)]
            jacobian = functools.reduce(jnp.multiply, [pair[1] for pair in pairs])
            return integrand(*[pair[0] for pair in pairs], *values) * jacobian

        return _adaptive_leg(axes, weighted, ranges, effort)

    return Source({"quadrature": build}, {"quadrature": evaluations_at_once(effort, len(ranges))})


def hemisphere(
    integrand: Callable,
    *,
    importance: Callable = hemisphere_angles,
    breaks: Sequence = ((), ()),
    nodes: int | None = None,
    panels: int | None = None,
    steps: int | None = None,
    tolerance: int | float | None = None,
) -> Source:
    """Return a source of ∫ `integrand(direction, *axes)` dω over the hemisphere about the z axis.

    `direction` (3,) is a unit vector. `importance(x, y, *axes)` maps the unit square to (direction,
    Jacobian), see `rules.directions`. A good map makes the integrand times the Jacobian smooth.
    `breaks` are in its coordinates x and y. The rest is as for `quadrature`.
    """
    effort = effort_of(2, nodes=nodes, panels=panels, steps=steps, tolerance=tolerance)
    ranges = ranges_of([(0, 1), (0, 1)], breaks)

    def build(axes: tuple[Axis, ...]) -> Leg:
        directions = check_map(importance, ["x", "y"], axes)
        check_function(integrand, ["direction"], [directions], axes)
        for pair in zip(ranges, probe_cube(2), strict=True):
            check_range(*pair, axes)

        def weighted(u, *values):
            direction, jacobian = importance(u[0], u[1], *values)
            return integrand(direction, *values) * jacobian

        return _adaptive_leg(axes, weighted, ranges, effort)

    return Source({"quadrature": build}, {"quadrature": evaluations_at_once(effort, 2)})


def sphere(
    integrand: Callable,
    *,
    importance: Callable = sphere_angles,
    breaks: Sequence | None = None,
    **effort,
) -> Source:
    """Return a source of ∫ `integrand(direction, *axes)` dω over the sphere.

    Arguments are as for `hemisphere`. There is a break at the horizon if neither `importance` nor
    `breaks` is given: many integrands have a kink there.
    """
    if breaks is None:
        breaks = ((0.5,), ()) if importance is sphere_angles else ((), ())
    return hemisphere(integrand, importance=importance, breaks=breaks, **effort)


def monte_carlo(
    integrand: Callable,
    *,
    importance: Callable | None = None,
    dimensions: int = 1,
    samples: int = 1 << 16,
    sequence: PointSequence = "random",
    seed: int = 0,
) -> Source:
    """Return a source that averages `samples` samples. The error is the standard error.

    `importance(x1, …, xk, *axes)` takes k = `dimensions` numbers that are uniform in [0, 1). It
    returns a place and the reciprocal of the place's probability density. A sample is
    `integrand(place, *axes)` divided by the density. The maps of `rules.directions` serve, with two
    dimensions. Without `importance`, a sample is `integrand(x1, …, xk, *axes)`.

    `sequence` is 'random' or 'sobol' (`monte_carlo.unit_points`). The leg takes `samples`,
    `sequence` and `seed` as keywords, too. The standard error is unreliable if few samples
    contribute most of the mean. The derivative of the leg misses jumps of the integrand.
    """
    if dimensions < 1:
        raise ValueError(f"dimensions = {dimensions}: at least 1 is needed")
    unit_points(samples, dimensions, sequence, seed)  # Raises ValueError if these do not fit.
    names = [f"x{j + 1}" for j in range(dimensions)]

    def sample(point, *values):
        if importance is None:
            return integrand(*point, *values)
        place, reciprocal = importance(*point, *values)
        return integrand(place, *values) * reciprocal

    def build(axes: tuple[Axis, ...]) -> Leg:
        if importance is None:
            check_function(integrand, names, list(probe_cube(dimensions)), axes)
        else:
            check_function(integrand, ["place"], [check_map(importance, names, axes)], axes)

        def evaluate(*values, samples=samples, sequence=sequence, seed=seed) -> Estimate:
            points = jnp.asarray(unit_points(samples, dimensions, sequence, seed))
            return mean_estimate(jax.vmap(jax.vmap(lambda point: sample(point, *values)))(points))

        return leg(*axes)(evaluate)

    return Source({"monte_carlo": build}, {"monte_carlo": samples})


def _adaptive_leg(axes: tuple[Axis, ...], integrand, ranges: list[Range], effort: Effort) -> Leg:
    """Return the leg that integrates `integrand(u, *axes)` over the unit cube."""

    def edges(*values) -> list[Array]:
        return [each.edges(values) for each in ranges]

    # Compiled once for each effort, as without `jit` every call would compile the loop anew.
    @functools.cache
    def compiled(effort: Effort):
        return jax.jit(lambda *values: adaptive(integrand, edges, values, effort))

    def evaluate(*values, **changes) -> Estimate:
        return compiled(effort_of(len(ranges), **{**effort._asdict(), **changes}))(*values)

    return leg(*axes)(evaluate)
