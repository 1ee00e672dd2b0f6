"""Running other programs: found or missing, within a time limit, in a folder that is removed."""

import os
import shutil
import subprocess
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from coefficients.files import unfinished

# A minute compiles the largest table several times over; what takes longer hangs.
TIME_LIMIT = 60.0


class ToolchainError(RuntimeError):
    """Code that did not compile or did not run: one line, and below it what the tool printed."""

    def __init__(self, summary: str, log: str = ""):
        super().__init__(f"{summary}\n{log.strip()}" if log.strip() else summary)
        self.summary = summary
        self.log = log.strip()


@contextmanager
def workspace() -> Generator[Path, None, None]:
    """Give a temporary folder for sources and programs, removed whatever happens."""
    with TemporaryDirectory(prefix="shadefit-") as folder, unfinished(Path(folder)) as path:
        yield path


def execute(
    command: Sequence[str | Path],
    *,
    failure: str,
    folder: Path | None = None,
    data: bytes = b"",
    seconds: float = TIME_LIMIT,
) -> bytes:
    """Run a program without a shell and give what it wrote to standard output.

    Arguments: `command`, program and arguments; `failure`, the line that begins the error when it
    fails; `folder`, where it runs; `data`, its standard input; `seconds`, its time limit. Raises
    ToolchainError when it cannot be started, does not end in time, or ends with a status.
    """
    words = [str(word) for word in command]
    try:
        done = subprocess.run(
            words, cwd=folder, input=data, capture_output=True, timeout=seconds, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise ToolchainError(f"{failure}: no end after {seconds:g} s", words[0]) from error
    except OSError as error:
        raise ToolchainError(f"{failure}: {words[0]} does not start", str(error)) from error
    if done.returncode != 0:
        # Compilers differ in which stream they complain on.
        log = (done.stdout + b"\n" + done.stderr).decode("utf-8", "replace")
        raise ToolchainError(f"{failure} (status {done.returncode})", log)
    return done.stdout


def command_path(name: str) -> Path | None:
    """Where a program is on PATH, or None."""
    found = shutil.which(name)
    return Path(found) if found else None


def packaged_file(package: str, file: str) -> Path | None:
    """Where an installed Python package holds a file, or None; the package is not imported."""
    try:
        spec = find_spec(package)
    except ModuleNotFoundError:
        return None
    if spec is None:
        return None
    for location in spec.submodule_search_locations or ():
        path = Path(location) / file
        if path.is_file():
            return path
    return None


@cache
def first_line(*command: str | Path) -> str:
    """Give the first line that a program prints (of its version, say), or its bare name."""
    name = Path(command[0]).name
    try:
        done = subprocess.run(
            [str(word) for word in command], capture_output=True, timeout=TIME_LIMIT, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return name
    lines = (done.stdout + done.stderr).decode("utf-8", "replace").split("\n")
    return next((line.strip() for line in lines if line.strip()), name)


def missing_command(name: str, package: str) -> str | None:
    """None when a program is on PATH; else a line that says so and what to install."""
    return None if command_path(name) else f"{name} is not on PATH (Debian: {package})"


def quiet_environment() -> dict[str, str]:
    """Give this environment without what makes graphics drivers talk or look for a screen."""
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    environment.setdefault("XDG_RUNTIME_DIR", "/tmp")
    return environment
