"""Files that are written completely or not at all."""

import os
import tempfile
from pathlib import Path

from programs.toolchains.temporary import unfinished


def require_writable(folder: Path) -> None:
    """Raise ValueError if files cannot be written into a folder. Call this before long work."""
    existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not existing.is_dir():
        raise ValueError(f"{existing} is no folder")
    try:
        # A file is really made: permissions do not show that a file system is read-only.
        tempfile.TemporaryFile(dir=existing).close()
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror}") from None


def require_writable_file(path: Path) -> None:
    """Raise ValueError if a file cannot be written. Call this before long work."""
    if path.is_dir():
        raise ValueError(f"{path} is a folder: allowed is a file's path")
    require_writable(path.parent)


def write_whole(path: Path, text: str) -> None:
    """Write a text file completely or not at all (see `write_whole_bytes`)."""
    write_whole_bytes(path, text.encode())


def write_whole_bytes(path: Path, data: bytes) -> None:
    """Write a file completely or not at all: a temporary file beside it is written, then renamed.

    The folder is made if it does not exist. Raises ValueError if it cannot be made, or if the file
    cannot be written.
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
