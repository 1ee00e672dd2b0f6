"""The time and memory of a command, which is measured as a process of its own."""

import os
import subprocess
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass

# Python keeps the modules that it compiled, as it does for users, whatever this machine's setting.
COMMON = {"OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": ""}


@dataclass(frozen=True)
class Run:
    """What a command took: wall and processor time in s, its peak memory in MiB, and its output."""

    wall: float
    processor: float
    mebibytes: float
    output: str


def run(command: list[str], variables: Mapping[str, str] | None = None) -> Run:
    """Run a command. The time of its child processes counts. Ends the program if it fails."""
    with tempfile.TemporaryFile("w+") as output:
        clock = time.perf_counter()
        environment = {**os.environ, **COMMON, **(variables or {})}
        child = subprocess.Popen(command, stdout=output, env=environment)
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - clock
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            raise SystemExit(f"{' '.join(command)} ended with {child.returncode}")
        output.seek(0)
        text = output.read()
    return Run(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, text)
