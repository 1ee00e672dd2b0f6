"""Exact values on several devices are those on one, to the last bit."""

import os
import subprocess
import sys

import jax
import numpy as np
import pytest

from fitting.points.grids import sobol_points
from integrals import PS, Q, R
from integrals.devices import all_devices, spread
from integrals.many_points import estimates_at_many
from integrals.reference import restricted

# The number of points is no multiple of a batch.
POINTS = {
    "ps": sobol_points(restricted(PS.axes, alpha=(0.05, 1.0)), 14, 1)[:9000],
    "q": np.linspace(0, 0.5, 301)[:, None],
    "r": sobol_points(restricted(R.axes, alpha=(0.15, 1.0)), 6, 1)[:50],
}


def values() -> dict[str, np.ndarray]:
    found = {each.name: each.values(POINTS[each.name]) for each in (PS, Q, R)}
    return {**found, "many": np.asarray(estimates_at_many(R, POINTS["r"]).value)}


_PROGRAM = """
import sys
import jax
import numpy as np
jax.config.update("jax_enable_x64", True)
from tests.integrals.test_devices import values
assert len(jax.devices()) == int(sys.argv[2])
np.savez(sys.argv[1], **values())
"""


def test_one_device_computes_all():
    assert len(all_devices()) == len(jax.devices())
    assert spread(values, all_devices()[:1]) is values


@pytest.mark.slow
def test_two_devices_give_the_bytes_of_one(tmp_path):
    # Both are processes of their own, because the tests themselves compile with other options.
    made = []
    for count in (1, 2):
        file = tmp_path / f"{count}.npz"
        flags = f"--xla_force_host_platform_device_count={count}"
        variables = {**os.environ, "XLA_FLAGS": flags, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-c", _PROGRAM, str(file), str(count)]
        subprocess.run(command, env=variables, check=True)
        made.append(np.load(file))
    alone, found = made
    for name in alone:
        assert np.isfinite(alone[name]).all()
        assert found[name].tobytes() == alone[name].tobytes(), name
