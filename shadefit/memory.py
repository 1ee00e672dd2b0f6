"""Memory that is given back to the system between the parts of a long command.

Compiling a program takes 10 to 50 MB that the C library keeps for later, in pieces, and JAX keeps
each compiled program. A command that draws many pictures would grow with their number.
"""

import ctypes
import gc
import os
import sys
from contextlib import suppress
from pathlib import Path

import jax

# Compiled programs are dropped if the process is larger than this, in bytes. The libraries, with
# some programs, take 0.35 GB.
KEPT_BELOW = 500_000_000
_STATUS = Path("/proc/self/statm")


def resident() -> int | None:
    """Return the bytes of memory that this process takes; None where the system does not say."""
    try:
        return int(_STATUS.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError, ValueError):
        return None


def give_back(kept_below: int = KEPT_BELOW) -> None:
    """Return memory to the system that is free within this process.

    If the process is still larger than `kept_below` bytes, what JAX compiled is dropped too; it is
    compiled again, or read from the cache of compiled programs, when it is called again.
    """
    trim()
    if (resident() or 0) > kept_below:
        jax.clear_caches()
        gc.collect()
        trim()


def trim() -> None:
    """Let the C library return what is free to the system. Only that of Linux (glibc) can."""
    if sys.platform == "linux":
        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).malloc_trim(0)
