"""Variables of the environment that would change numbers, or end a command with a traceback.

The same command writes the same bytes in any environment, so these variables are set or removed
before the libraries that read them are imported. A variable of JAX that is not known here is
removed too: most of them change what is computed, and JAX does not start with a wrong value.
"""

import os
import re
from collections.abc import MutableMapping


def _processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


# References need float64 on the processor. With more threads of OpenBLAS, the order of sums, and so
# their last digits, would depend on the machine. XLA reads the number of its threads from NPROC.
# One thread adds in another order than several, but how many these are makes no difference: so a
# single processor gets two threads. Pictures are written to files only.
_SET = {
    "JAX_ENABLE_X64": "1",
    "JAX_PLATFORMS": "cpu",
    "OPENBLAS_NUM_THREADS": "1",
    "NPROC": str(max(2, _processors())),
    "MPLBACKEND": "agg",
}
# JAX, Equinox (EQX_ON_ERROR), and what chooses other code for sums and elementary functions
_REMOVED = re.compile(r"JAX_.*|EQX_.*|NPY_(EN|DIS)ABLE_CPU_FEATURES|OPENBLAS_CORETYPE")
# Where JAX keeps compiled code does not change it.
_KEPT = re.compile(
    r"JAX_COMPILATION_CACHE_DIR|JAX_ENABLE_COMPILATION_CACHE|JAX_PERSISTENT_CACHE_.*"
)
# Tables are empty in a width of 0, and text is filled up with spaces to a huge one.
_SIZE = re.compile(r"[1-9][0-9]{0,3}")
# XLA ends the process if it does not know a flag. This one says how many devices there are.
_XLA_FLAGS = "XLA_FLAGS"
_KEPT_FLAG = re.compile(r"--xla_force_host_platform_device_count=[1-9]\d{0,3}")


def fix_environment(environment: MutableMapping[str, str] = os.environ) -> None:
    """Set or remove every variable that would change what a command computes, or make it fail."""
    for name in list(environment):
        if _REMOVED.fullmatch(name) and not _KEPT.fullmatch(name):
            del environment[name]
    for name in ("COLUMNS", "LINES"):
        if not _SIZE.fullmatch(environment.get(name, "")):
            environment.pop(name, None)
    flags = environment.pop(_XLA_FLAGS, "").split()
    kept = [flag for flag in flags if _KEPT_FLAG.fullmatch(flag)]
    if kept:
        environment[_XLA_FLAGS] = " ".join(kept)
    environment.update(_SET)
