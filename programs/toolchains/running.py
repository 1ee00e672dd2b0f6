"""Programs that this process has started, and how they end together with all that they started.

A compiler starts others. Each program leads a process group of its own, which is killed as a whole.
"""

import os
import signal
import subprocess
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

_RUNNING: set[subprocess.Popen] = set()
# Held while a program starts or is given up, and for good once the process ends.
_OPEN = threading.Lock()


def start(words: Sequence[str], **options: Any) -> subprocess.Popen:
    """Start a program without a shell; `options` are those of `subprocess.Popen`.

    The caller ends it by `end`. Raises OSError if it does not start.
    """
    with _OPEN:
        process = subprocess.Popen(words, process_group=0, **options)
        _RUNNING.add(process)
    return process


def end(process: subprocess.Popen) -> None:
    """Kill a program and all that it started, if it still runs, and wait for it.

    Once `end_all` has killed it, this does not return: the caller would complain of a program that
    failed, while another thread ends the process.
    """
    if process.poll() is None:
        _kill(process)
        process.wait()
    for each in (process.stdin, process.stdout, process.stderr):
        if each is not None:
            with suppress(OSError):
                each.close()
    with _OPEN:
        _RUNNING.discard(process)


def run(
    words: Sequence[str], seconds: float, folder: Path | None = None, data: bytes = b""
) -> tuple[int, bytes, bytes]:
    """Run a program: its status, and what it wrote to standard output and to standard error.

    Arguments: `seconds`, its time limit; `folder`, where it runs; `data`, its standard input.
    Raises OSError if it does not start, and subprocess.TimeoutExpired if it does not end in time.
    """
    pipe = subprocess.PIPE
    process = start(words, cwd=folder, stdin=pipe, stdout=pipe, stderr=pipe)
    try:
        out, error = process.communicate(data, timeout=seconds)
    finally:
        end(process)
    return process.returncode, out, error


def end_all() -> None:
    """Kill all programs; for handlers of signals that end the process.

    After it, no program can start, and those who wait for one wait for good.
    """
    _OPEN.acquire()
    for process in tuple(_RUNNING):
        _kill(process)


def _kill(process: subprocess.Popen) -> None:
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
