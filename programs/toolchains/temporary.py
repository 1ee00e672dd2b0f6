"""Files and folders that exist only while work goes on.

They are removed when the work ends. If a signal ends the process, its handler removes the rest.
"""

import secrets
import shutil
import tempfile
import threading
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

_UNFINISHED: set[Path] = set()
# Held while a path is registered, and for good once the process ends.
_OPEN = threading.Lock()


@contextmanager
def unfinished(path: Path) -> Generator[Path, None, None]:
    """Register a file or folder so that `discard_unfinished` would remove it.

    Register it before it is made: then no signal comes between.
    """
    with _OPEN:
        _UNFINISHED.add(path)
    try:
        yield path
    finally:
        _UNFINISHED.discard(path)


@contextmanager
def temporary_folder() -> Generator[Path, None, None]:
    """Make a temporary folder; it is removed whatever happens."""
    with unfinished(Path(tempfile.gettempdir()) / f"shadefit-{secrets.token_hex(8)}") as path:
        path.mkdir(mode=0o700)
        try:
            yield path
        finally:
            shutil.rmtree(path, ignore_errors=True)


def discard_unfinished(at_end: bool = False) -> None:
    """Remove all registered files and folders; for handlers of signals that end the process.

    `at_end`: the process ends now. Threads that would register another path wait until then.
    """
    if at_end:
        _OPEN.acquire()
    for path in tuple(_UNFINISHED):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
