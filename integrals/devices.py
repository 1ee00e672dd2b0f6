"""Exact values on all devices of this process, such as several GPUs.

Every device computes a part of the points by the program that one device would run, so values have
the same bytes on any number of devices.
"""

from collections.abc import Callable

import jax
import numpy as np
from jax import Device
from jax.sharding import Mesh, PartitionSpec


def all_devices() -> tuple[Device, ...]:
    """Return the devices of this process."""
    return tuple(jax.local_devices())


def spread(function: Callable, devices: tuple[Device, ...]) -> Callable:
    """Let each device apply a function of points (n, …) to its part of them.

    The number of points must be a multiple of the number of devices. The results are joined in the
    order of the points. For one device this is the function itself.
    """
    if len(devices) == 1:
        return function
    part = PartitionSpec("points")
    mesh = Mesh(np.array(devices), ("points",))
    # The parts have nothing to do with each other: there is nothing to check.
    return jax.shard_map(function, mesh=mesh, in_specs=part, out_specs=part, check_vma=False)
