"""Running other programs, with a time limit and in temporary folders; and finding them."""

import os
import shutil
import subprocess
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from programs.toolchains.running import run
from programs.toolchains.temporary import temporary_folder

# Seconds. The largest table compiles in a fraction of it; a tool that takes longer has hung.
TIME_LIMIT = 60.0


class ToolchainError(RuntimeError):
    """Code did not compile or did not run: `summary` is one line, `log` what the tool printed."""

    def __init__(self, summary: str, log: str = ""):
        super().__init__(f"{summary}\n{log.strip()}" if log.strip() else summary)
        self.summary = summary
        self.log = log.strip()


@contextmanager
def workspace() -> Generator[Path, None, None]:
    """Make a temporary folder for sources and programs; it is removed whatever happens."""
    with temporary_folder() as path:
        yield path


def execute(
    command: Sequence[str | Path],
    *,
    failure: str,
    folder: Path | None = None,
    data: bytes = b"",
    seconds: float = TIME_LIMIT,
) -> bytes:
    """Run a program without a shell and return its standard output.

    Arguments: `command`, the program and its arguments; `failure`, the first line of the error if
    it fails; `folder`, where it runs; `data`, its standard input; `seconds`, its time limit. Raises
    ToolchainError when it cannot be started, does not end in time, or ends with a status other than
    zero.
    """
    words = [str(word) for word in command]
    try:
        status, out, complaint = run(words, seconds, folder, data)
    except subprocess.TimeoutExpired as error:
        raise ToolchainError(f"{failure}: no end after {seconds:g} s", words[0]) from error
    except OSError as error:
        raise ToolchainError(f"{failure}: {words[0]} does not start", str(error)) from error
    if status != 0:
        # Some compilers print errors to standard output.
        log = (out + b"\n" + complaint).decode("utf-8", "replace")
        raise ToolchainError(f"{failure} (status {status})", log)
    return out


def command_path(name: str) -> Path | None:
    """Return the path of a program on PATH, or None."""
    found = shutil.which(name)
    return Path(found) if found else None


def packaged_file(package: str, file: str) -> Path | None:
    """Return the path of a file in an installed Python package, or None; nothing is imported."""
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
    """Return the first line that a program prints, such as its version; its name if it fails."""
    name = Path(command[0]).name
    try:
        _, out, complaint = run([str(word) for word in command], TIME_LIMIT)
    except (OSError, subprocess.TimeoutExpired):
        return name
    lines = (out + complaint).decode("utf-8", "replace").split("\n")
    return next((line.strip() for line in lines if line.strip()), name)


def missing_command(name: str, package: str) -> str | None:
    """Return None if a program is on PATH, else a line that names the Debian package to install."""
    return None if command_path(name) else f"{name} is not on PATH (Debian: {package})"


def quiet_environment() -> dict[str, str]:
    """Return the environment variables, changed so that graphics drivers print nothing.

    Without DISPLAY, they do not look for a screen; without XDG_RUNTIME_DIR, they would complain.
    """
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    environment.setdefault("XDG_RUNTIME_DIR", "/tmp")
    return environment
