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
from integrals.reference import Estimate, Reference

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
    if reference.smooth_along is not None:
        return estimates_along_lines(reference, points, exact)
    return exact(points)


def _in_groups(reference: Reference, points: np.ndarray) -> Estimate:
    """Evaluate points (n, axes), with n > 0; those with the same needs together."""
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


@functools.lru_cache(maxsize=16)
def _one_by_one(
    reference: Reference, options: tuple[tuple[str, Any], ...], devices: tuple[Device, ...]
) -> Callable[[np.ndarray], Estimate]:
    leg = reference.legs[reference.best_leg]

    def evaluate(points):
        return jax.lax.map(lambda x: leg(*x, **dict(options)), points)

    return jit_for_few_calls(spread(evaluate, devices))
