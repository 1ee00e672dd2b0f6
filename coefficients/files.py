"""Files that are written whole or not at all."""

import os
import shutil
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

# Files and folders that are removed if the program ends before they are done.
_UNFINISHED: set[Path] = set()


@contextmanager
def unfinished(path: Path) -> Generator[Path, None, None]:
    """Note a file or folder that is for a while only: it is removed if the program is ended."""
    _UNFINISHED.add(path)
    try:
        yield path
    finally:
        _UNFINISHED.discard(path)


def discard_unfinished() -> None:
    """Remove what is for a while only: the program is about to be ended."""
    for path in tuple(_UNFINISHED):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def require_writable(folder: Path) -> None:
    """Raise ValueError now, rather than after the work, if files cannot be made in a folder."""
    existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not existing.is_dir():
        raise ValueError(f"{existing} is no folder")
    try:
        # To ask is not enough: the superuser may write anything, but not to every file system.
        tempfile.TemporaryFile(dir=existing).close()
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror}") from None


def require_writable_file(path: Path) -> None:
    """Raise ValueError now, rather than after the work, if a file cannot be written."""
    if path.is_dir():
        raise ValueError(f"{path} is a folder: allowed is a file's path")
    require_writable(path.parent)


def write_whole(path: Path, text: str) -> None:
    """Write a text file whole or not at all (`write_whole_bytes`)."""
    write_whole_bytes(path, text.encode())


def write_whole_bytes(path: Path, data: bytes) -> None:
    """Write a file whole or not at all: to a temporary file beside it, then renamed.

    Raises ValueError where the folder cannot be made or written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise ValueError(f"{path.parent} cannot be written: {error.strerror}") from None
    try:
        with unfinished(Path(temporary)):
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
    except OSError as error:
        raise ValueError(f"{path} cannot be written: {error.strerror}") from None
    finally:
        Path(temporary).unlink(missing_ok=True)
