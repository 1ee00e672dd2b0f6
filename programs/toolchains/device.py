"""Running compute shaders on a Vulkan device, which may be the processor (Mesa's lavapipe).

A worker process (`device_worker.py`) opens the device at first use and keeps it open, because that
takes seconds. A shader that hangs or crashes the driver ends the worker, not this process.
"""

import atexit
import subprocess
import sys
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any

import numpy as np

from programs.functions import Function
from programs.toolchains.interface import compile_failure, result_count, run_failure
from programs.toolchains.process import TIME_LIMIT, ToolchainError, packaged_file, quiet_environment
from programs.toolchains.running import end, start

# Precision -> the feature of the device that it needs; float needs none.
FEATURES = {"half": "shader-f16", "double": "shader-f64"}


@dataclass(frozen=True)
class _Worker:
    process: subprocess.Popen
    connection: Connection
    errors: IO[bytes]
    device: dict[str, Any]


_workers: list[_Worker] = []
_failures: list[str] = []


def missing_reason(precision: str) -> str | None:
    """Return None if a Vulkan device can compute in a precision, else the reason."""
    try:
        device = _worker().device
    except ToolchainError as error:
        return error.summary
    feature = FEATURES.get(precision)
    if feature is not None and feature not in device["features"]:
        return f"the Vulkan device ({device['name']}) has no {feature}"
    return None


def versions() -> str:
    """Name the device and the library that drives it."""
    try:
        device = _worker().device
    except ToolchainError as error:
        return error.summary
    return f"wgpu {device['wgpu']} on {device['name']}"


def evaluate(
    language: str,
    code: str | bytes,
    function: Function,
    inputs: np.ndarray,
    precision: str,
) -> np.ndarray:
    """Run a compute shader on all rows.

    Its entry point is `main`, with groups of 64. Binding 0 is the buffer of the inputs and binding
    1 that of the values, both row by row; their numbers are doubles in double precision and floats
    otherwise. Arguments: `language`, its name for error messages; `code`, WGSL text or SPIR-V
    bytes; the rest as in `Toolchain`. Returns (n, m) float64. Raises ToolchainError when the driver
    refuses the shader, does not answer in time, or crashes.
    """
    worker = _worker()
    kind = np.dtype(np.float64 if precision == "double" else np.float32)
    rows, width = inputs.shape
    count = result_count(function)
    data = inputs.astype(kind).tobytes()
    failure = run_failure(language, function, precision)
    try:
        worker.connection.send((code, data, rows, kind.itemsize, width, count))
        if not worker.connection.poll(TIME_LIMIT):
            log = _end(worker)
            raise ToolchainError(f"{failure}: no end after {TIME_LIMIT:g} s", log)
        reply, complaint = worker.connection.recv()
    except (EOFError, OSError) as error:
        raise ToolchainError(f"{failure}: the device's process ended", _end(worker)) from error
    if complaint is not None:
        raise ToolchainError(compile_failure(language, function, precision), complaint)
    return np.frombuffer(reply, kind).reshape(rows, count).astype(np.float64)


def _worker() -> _Worker:
    if _workers:
        return _workers[-1]
    if _failures:
        raise ToolchainError(_failures[-1])
    if packaged_file("wgpu", "__init__.py") is None:
        raise ToolchainError("wgpu is not installed (PyPI: wgpu)")
    try:
        _workers.append(_start())
    except ToolchainError as error:
        # Remember the failure: opening is not tried again for every language.
        _failures.append(error.summary)
        raise
    return _workers[-1]


def _start() -> _Worker:
    ours, theirs = Pipe()
    errors = TemporaryFile()  # noqa: SIM115 - lives as long as the worker
    script = Path(__file__).with_name("device_worker.py")
    process = start(
        [sys.executable, "-I", str(script), str(theirs.fileno())],
        pass_fds=(theirs.fileno(),),
        stdin=subprocess.DEVNULL,
        stdout=errors,
        stderr=errors,
        env=quiet_environment(),
    )
    theirs.close()
    worker = _Worker(process, ours, errors, {})
    try:
        device, complaint = ours.recv() if ours.poll(TIME_LIMIT) else (None, "no answer")
    except EOFError:
        device, complaint = None, "its process ended"
    if device is None:
        log = _end(worker)
        raise ToolchainError(
            f"no Vulkan device opens: {complaint} (Debian: mesa-vulkan-drivers libvulkan1)", log
        )
    return _Worker(process, ours, errors, device)


def _end(worker: _Worker) -> str:
    """End a worker and return what it printed."""
    if worker in _workers:
        _workers.remove(worker)
    worker.connection.close()
    end(worker.process)
    worker.errors.seek(0)
    log = worker.errors.read().decode("utf-8", "replace")
    worker.errors.close()
    return log


@atexit.register
def _end_all() -> None:
    for worker in list(_workers):
        _end(worker)
