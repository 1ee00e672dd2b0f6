"""`make_reference`, which joins a source or data with axes to the reference of a quantity."""

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import jax
import numpy as np

from integrals.data import Data
from integrals.reference import Axis, Reference
from integrals.sampling import Measure, Sampling
from integrals.sources import Source
from integrals.user_functions import check_function

# The codomain of a quantity that does not state one.
EVERYTHING = (-math.inf, math.inf)
# Values of the integrand that `Reference.estimates` keeps in memory at once. They fit in the cache.
# Larger batches are slower, too: every point of a batch takes as many steps as its hardest point.
_VALUES_AT_ONCE = 1 << 17
_LARGEST_BATCH = 8192


def make_reference(
    source: Source | Data | Sequence[Source],
    *,
    name: str,
    axes: Sequence[Axis],
    symbol: str = "",
    meaning: str = "",
    definition: str = "",
    sampling: Sampling | None = None,
    codomain: tuple[float | int, float | int] = EVERYTHING,
) -> Reference:
    """Return the reference of a quantity with these axes. A sequence of sources is added up.

    `symbol` is `name` if it is not given. Raises ValueError as `Source.legs` does, without
    axes, and for data outside the axes' domains or with another number of axes.
    """
    if not axes:
        raise ValueError("axes = []: at least one Axis is needed")
    legs, data, batch = {}, None, _LARGEST_BATCH
    if isinstance(source, Data):
        data, default = source, Sampling(fitted=11, checked=11, judged=11, climbs=False)
        _require_inside(data, axes)
    else:
        total = source if isinstance(source, Source) else functools.reduce(Source.__add__, source)
        legs = total.legs(axes)
        at_once = total.at_once[next(iter(legs))]
        batch = max(1, min(_LARGEST_BATCH, _VALUES_AT_ONCE // at_once))
        default = _sampling(len(axes), at_once)
    return Reference(
        name=name,
        symbol=symbol or name,
        meaning=meaning,
        definition=definition,
        axes=tuple(axes),
        sampling=sampling or default,
        batch=batch,
        closed_form=legs.get("closed_form"),
        quadrature=legs.get("quadrature"),
        monte_carlo=legs.get("monte_carlo"),
        codomain=(float(codomain[0]), float(codomain[1])),
        data=data,
        few_calls=True,
    )


def _require_inside(data: Data, axes: Sequence[Axis]) -> None:
    """Raise ValueError unless all points of the data are in the domains of the axes."""
    if data.points.shape[1] != len(axes):
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(
            f"{data.source} has {data.points.shape[1]} columns of points: expected is one for each "
            f"of {names}"
        )
    for k, axis in enumerate(axes):
        for row in np.flatnonzero(~axis.contains(data.points[:, k]))[:1]:
            raise ValueError(
                f"{data.source}, row {row + 1}: {axis.name} = {data.points[row, k]:g} is outside "
                f"its domain {axis.domain}"
            )


def _sampling(axes: int, at_once: int) -> Sampling:
    """Return the default numbers of points for a number of axes.

    `at_once` is the number of values of an integrand that a point needs; 1 for a closed form. A
    closed form has as many points as a built-in quantity with as many axes. An integral has about
    as many for the search for large errors, instead of hill climbing: values near those that were
    computed already would be computed again and again. If a point needs over 1000 values, it takes
    milliseconds, and the numbers are those of R.
    """
    if at_once > 1000:
        return Sampling(fitted=11, checked=10, judged=12, climbs=False, verified=1 << 12)
    if at_once > 1:
        most = 14 if axes == 1 else 15
        return Sampling(fitted=12, checked=most, judged=14, climbs=False, verified=1 << 14)
    if axes == 1:
        return Sampling(fitted=11, checked=13, judged=16)
    return Sampling(fitted=13, checked=15, judged=16 if axes == 2 else 17)


def weighted(reference: Reference, weight: Callable[..., Any]) -> Reference:
    """Return a reference whose errors are multiplied by a function of the axes in all fits.

    Raises ValueError if the function takes other arguments, or is NaN at a point that is tried.
    """
    check_function(weight, [], [], reference.axes)

    def weights(points: np.ndarray) -> np.ndarray:
        with jax.enable_x64(True):
            return np.asarray(jax.vmap(weight)(*points.T))

    measure = Measure(lambda points: weights(points) ** 2, weights)
    return replace(reference, sampling=replace(reference.sampling, measures={"weight": measure}))
