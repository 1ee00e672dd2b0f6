"""Checks of functions that a user gives, with errors that name the function and its line."""

import inspect
import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import jax
import numpy as np

from integrals.reference import Axis
from integrals.rules.ranges import Range

# A function is tried at this many points before it is used, the corners of the domain among them.
PROBES = 64
# An end that does not belong to the domain is replaced by this fraction of it.
_LEAST = 1e-3


def label(function: Callable) -> str:
    """Return a function with its file, line and signature, such as 'my.py:5: f(t, eta)'."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    place = f"{Path(code.co_filename).name}:{code.co_firstlineno}: " if code else ""
    name = getattr(function, "__name__", type(function).__name__).replace("<lambda>", "lambda")
    names = _parameters(function)
    return f"{place}{name}({', '.join(names)})" if names is not None else f"{place}{name}"


def require_arguments(function: Callable, variables: Sequence[str], axes: Sequence[Axis]) -> None:
    """Raise ValueError unless `function` can be called with the variables and then the axes."""
    wanted = [*variables, *(axis.name for axis in axes)]
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return  # Some compiled functions have no signature: a call will tell.
    try:
        signature.bind(*wanted)
    except TypeError:
        before = f"{', '.join(variables)} and then " if variables else ""
        noun = "the axis" if len(axes) == 1 else "the axes"
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(
            f"{label(function)} cannot take {len(wanted)} arguments: expected are "
            f"{before}{noun} {names}"
        ) from None


def require_values(function: Callable, arguments: Sequence[np.ndarray], names: Sequence[str]):
    """Return the values of `function` at arguments with a first dimension of `PROBES`.

    Raises ValueError if it does not return a scalar, or if a value is NaN. `names` of the arguments
    are for the message.
    """
    with jax.enable_x64(True):
        found = jax.vmap(function)(*arguments)
    if np.shape(found) != (PROBES,):
        shape = np.shape(found)[1:] if hasattr(found, "shape") else type(found).__name__
        raise ValueError(f"{label(function)} returns {shape}: expected is a scalar")
    values = np.asarray(found)
    if np.iscomplexobj(values):
        raise ValueError(f"{label(function)} returns complex numbers: expected are real ones")
    for index in np.flatnonzero(np.isnan(values)):
        point = describe(names, [each[index] for each in arguments])
        raise ValueError(f"{label(function)} is NaN at {point}")
    return values


def check_function(
    function: Callable, names: Sequence[str], variables: Sequence[np.ndarray], axes: Sequence[Axis]
) -> np.ndarray:
    """Try a scalar function of variables and axes, and return its values at the probes.

    `variables` have a first dimension of `PROBES`. Raises ValueError as the two checks above do.
    """
    require_arguments(function, names, axes)
    every = [*names, *(axis.name for axis in axes)]
    return require_values(function, [*variables, *probe_axes(axes)], every)


def check_map(function: Callable, names: Sequence[str], axes: Sequence[Axis]) -> np.ndarray:
    """Try a map from the unit cube to (place, Jacobian), and return the places at the probes."""
    require_arguments(function, names, axes)
    arguments = [*probe_cube(len(names)), *probe_axes(axes)]
    with jax.enable_x64(True):
        found = jax.vmap(function)(*arguments)
    if not (isinstance(found, tuple) and len(found) == 2 and np.shape(found[1]) == (PROBES,)):
        raise ValueError(f"{label(function)} has to return a place and a Jacobian")
    place, jacobian = map(np.asarray, found)
    bad = np.isnan(jacobian) | np.isnan(place.reshape(PROBES, -1)).any(axis=1) | (jacobian < 0)
    for index in np.flatnonzero(bad):
        every = [*names, *(axis.name for axis in axes)]
        point = describe(every, [each[index] for each in arguments])
        raise ValueError(f"{label(function)} is NaN or has a negative Jacobian at {point}")
    return place


def check_range(range_: Range, fractions: np.ndarray, axes: Sequence[Axis]) -> np.ndarray:
    """Try a range of integration and return the variable at `fractions` (PROBES,) of it.

    Its length may be zero on a face of the domain, as of a cone without an angle: the integral is
    zero there. Raises ValueError if the upper end is below the lower one at a probe, if both are
    equal at all, or if an end or a break is NaN.
    """
    ends = []
    for place in (range_.lower, range_.upper, *range_.breaks):
        constant = np.full(PROBES, np.nan if callable(place) else place)
        ends.append(check_function(place, [], [], axes) if callable(place) else constant)
    values = probe_axes(axes)
    empty = ends[0] > ends[1] if np.any(ends[0] < ends[1]) else ends[0] >= ends[1]
    for index in np.flatnonzero(empty):
        point = describe([axis.name for axis in axes], [each[index] for each in values])
        interval = f"({ends[0][index]:.6g}, {ends[1][index]:.6g})"
        raise ValueError(f"over {interval} at {point}: the interval is empty")
    with jax.enable_x64(True):
        found = jax.vmap(lambda u, *values: range_.place(u, values)[0])(fractions, *values)
    return np.asarray(found)


def describe(names: Sequence[str], values: Sequence[Any]) -> str:
    """Return a point as text, such as 't = 0.5, eta = 1.2'."""
    texts = [np.array2string(np.asarray(value), precision=6, separator=", ") for value in values]
    return ", ".join(f"{name} = {text}" for name, text in zip(names, texts, strict=True))


def probe_axes(axes: Sequence[Axis]) -> list[np.ndarray]:
    """Return values in the domain of each axis, (PROBES,) each. The same every time.

    The first ones are the corners of the domain, without ends that do not belong to it.
    """
    fractions = probe_cube(len(axes), seed=1)
    corners = list(itertools.islice(itertools.product((0.0, 1.0), repeat=len(axes)), PROBES // 2))
    fractions[:, : len(corners)] = np.transpose(corners)
    return [_inside(axis, fraction) for axis, fraction in zip(axes, fractions, strict=True)]


def probe_cube(variables: int, seed: int = 0) -> np.ndarray:
    """Return points inside the unit cube, (variables, PROBES). The same every time."""
    return np.random.default_rng(seed).random((variables, PROBES))


def _inside(axis: Axis, fraction: np.ndarray) -> np.ndarray:
    if axis.open_below:
        fraction = np.maximum(fraction, _LEAST)
    if math.isinf(axis.upper):
        fraction = np.minimum(fraction, 1 - _LEAST)
        return axis.lower + fraction / (1 - fraction)
    return axis.place(fraction)


def _parameters(function: Callable) -> list[str] | None:
    try:
        return [str(each.replace(annotation=each.empty)) for each in _signature(function)]
    except (TypeError, ValueError):
        return None


def _signature(function: Callable) -> list[inspect.Parameter]:
    return list(inspect.signature(function).parameters.values())
