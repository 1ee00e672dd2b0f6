"""Files and folders that exist only while work goes on.

They are removed when the work ends. If a signal ends the process, its handler removes the rest.
"""

import shutil
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

_UNFINISHED: set[Path] = set()


@contextmanager
def unfinished(path: Path) -> Generator[Path, None, None]:
    """Register a file or folder, which exists, so that `discard_unfinished` would remove it."""
    _UNFINISHED.add(path)
    try:
        yield path
    finally:
        _UNFINISHED.discard(path)


def discard_unfinished() -> None:
    """Remove all registered files and folders; for handlers of signals that end the process."""
    for path in tuple(_UNFINISHED):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
