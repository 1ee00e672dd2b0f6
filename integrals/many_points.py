"""Exact values at many points, such as those of a texture, of quantities that are slow to evaluate.

`Reference.estimates` evaluates a batch of points at once, and all its points with the options that
the hardest of them needs. Here, points with the same needs are evaluated together, one after the
other, which needs less memory and so less time.
"""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Device

from integrals.along_lines import estimates_along_lines
from integrals.batches import in_batches
from integrals.compilation import jit_for_few_calls
from integrals.devices import all_devices, spread
from integrals.reference import Estimate, Reference, require_float64

# A quantity with smaller batches has so many nodes at a point that one point fills the cache.
_SMALL_BATCH = 256
# Neighbouring points that get the same options, and points that are evaluated by one call.
_BLOCK, _AT_ONCE = 64, 512


def estimates_at_many(reference: Reference, points: np.ndarray) -> Estimate:
    """Evaluate the most exact leg at points (n, axes). Returns values and errors, (n,) each.

    This is `Reference.estimates`, but faster for many points of a quantity that is an integral
    without a closed form, such as R. Its values may differ within the stated errors.
    """
    if len(points) == 0:
        return Estimate(jnp.zeros(0), jnp.zeros(0))
    if reference.batch >= _SMALL_BATCH:
        return reference.estimates(points)
    exact = functools.partial(_in_groups, reference)
    for smooth in reversed(reference.smooth_along):
        exact = functools.partial(estimates_along_lines, reference, smooth, exact=exact)
    return exact(points)


def _in_groups(reference: Reference, points: np.ndarray) -> Estimate:
    """Evaluate points (n, axes), with n > 0; those with the same needs together."""
    if reference.many is not None:
        return _by_rule_for_many(reference, points)
    order = np.lexsort(points.T[::-1])
    groups: dict[tuple[tuple[str, Any], ...], list[np.ndarray]] = {}
    for first in range(0, len(points), _BLOCK):
        block = order[first : first + _BLOCK]
        options = tuple(reference.options_at(points[block]).items())
        groups.setdefault(options, []).append(block)
    value, error = np.empty(len(points)), np.empty(len(points))
    for options, blocks in groups.items():
        index = np.concatenate(blocks)
        devices = all_devices()
        one_by_one = _one_by_one(reference, options, devices)
        found = in_batches(one_by_one, points[index], _AT_ONCE * len(devices))
        value[index], error[index] = np.asarray(found.value), np.asarray(found.error)
    return Estimate(jnp.asarray(value), jnp.asarray(error))


def _by_rule_for_many(reference: Reference, points: np.ndarray) -> Estimate:
    devices = all_devices()
    found = in_batches(_many(reference, devices), points, _AT_ONCE * len(devices))
    inside = np.all([axis.contains(points[:, k]) for k, axis in enumerate(reference.axes)], axis=0)
    return Estimate(*(jnp.where(inside, each, jnp.nan) for each in found))


@functools.lru_cache(maxsize=16)
def _many(reference: Reference, devices: tuple[Device, ...]) -> Callable[[np.ndarray], Estimate]:
    require_float64()
    assert reference.many is not None
    return jit_for_few_calls(spread(reference.many, devices))


@functools.lru_cache(maxsize=16)
def _one_by_one(
    reference: Reference, options: tuple[tuple[str, Any], ...], devices: tuple[Device, ...]
) -> Callable[[np.ndarray], Estimate]:
    leg = reference.legs[reference.best_leg]

    def evaluate(points):
        return jax.lax.map(lambda x: leg(*x, **dict(options)), points)

    return jit_for_few_calls(spread(evaluate, devices))
