"""Memory: what is free goes back to the system, and long commands stay below a gigabyte."""

import subprocess
import sys
from pathlib import Path

import jax
import jax.numpy as jnp
import pytest

from shadefit import memory

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")
# Bytes that a command may take. It took less by a tenth at least when this was written.
BUDGET = 1_000_000_000
_COMMAND = r"""
import re, sys
from pathlib import Path
from shadefit.cli import main
sys.argv = ["shadefit", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
# The peak of getrusage would count the process that started this one, too.
print(re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[1])
"""


def peak(*arguments: str) -> int:
    """Run a command without the cache of compiled programs. Return its peak memory in bytes."""
    done = subprocess.run(
        [sys.executable, "-c", _COMMAND, *arguments], capture_output=True, text=True, check=True
    )
    return 1024 * int(done.stdout.splitlines()[-1])


@LINUX
def test_free_memory_goes_back_to_the_system():
    """Many small blocks stay with the C library when they are freed, until they are given back."""
    before = memory.resident()
    blocks = [bytes([number % 251]) * (1 << 16) for number in range(2000)]
    held = memory.resident()
    assert before is not None and held is not None
    assert held - before > 100e6
    # The last one keeps the top of the heap from shrinking.
    del blocks[:-1]
    kept = memory.resident()
    assert kept is not None and held - kept < 50e6
    memory.give_back(kept_below=1 << 60)
    after = memory.resident()
    assert after is not None and held - after > 100e6


@LINUX
def test_programs_are_dropped_only_beyond_the_limit():
    compiled = 0

    @jax.jit
    def twice(x):
        nonlocal compiled
        compiled += 1
        return 2 * x

    for limit, count in ((1 << 60, 1), (0, 2)):
        twice(jnp.ones(3))
        memory.give_back(kept_below=limit)
        assert float(twice(jnp.ones(3)).sum()) == 6
        assert compiled == count


def test_a_system_that_does_not_say_its_memory_keeps_programs(monkeypatch):
    monkeypatch.setattr(memory, "_STATUS", Path("/proc/none"))
    assert memory.resident() is None
    memory.give_back(kept_below=0)
