"""Files that are written completely or not at all, and streams that are written through."""

import errno
import os
import secrets
import stat
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from programs.toolchains.temporary import unfinished

# The path that stands for standard output
OUTPUT = Path("-")
_STDOUT = 1
# A folder cannot be synchronised on every file system; these errors say so.
_NO_SYNC = (errno.EINVAL, errno.ENOTSUP, errno.EBADF, errno.EACCES)


class ReaderGoneError(Exception):
    """Nothing reads any more from a pipe that is written. It is no error of the command."""


def require_writable(folder: Path) -> None:
    """Raise ValueError if files cannot be written into a folder. Call this before long work."""
    try:
        existing = next(path for path in (folder, *folder.absolute().parents) if _is_there(path))
        if not existing.is_dir():
            raise ValueError(f"{existing} is no folder")
        # A file is really made: permissions do not show that a file system is read-only.
        tempfile.TemporaryFile(dir=existing).close()
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror or error}") from None


def _is_there(path: Path) -> bool:
    """Return whether a path is in use, also by a symbolic link that leads nowhere."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def require_writable_file(path: Path) -> None:
    """Raise ValueError if a file cannot be written. Call this before long work."""
    try:
        found = _found(path)
        if found is not None and stat.S_ISDIR(found.st_mode):
            raise ValueError(f"{path} is a folder: allowed is a file's path")
        if found is not None:
            _require_permission(path, found)
    except OSError as error:
        raise ValueError(f"{path} cannot be written: {error.strerror or error}") from None
    if not _is_stream(path, found):
        require_writable(Path(os.path.realpath(path)).parent if path.is_symlink() else path.parent)


def is_standard_output(path: Path) -> bool:
    """Return whether a path stands for standard output: '-', /dev/stdout, or a link to them."""
    return path == OUTPUT or _open_file(path) == _STDOUT


def write_whole(path: Path, text: str) -> None:
    """Write a text file completely or not at all (see `write_whole_bytes`)."""
    write_whole_bytes(path, text.encode())


def write_whole_bytes(path: Path, data: bytes) -> None:
    """Write a file completely or not at all: a temporary file beside it is written, then renamed.

    The folder is made if it does not exist. A new file has the permissions of the process's umask,
    a file that is replaced keeps its own. A symbolic link stays, and the file that it leads to is
    replaced. Other names (hard links) of the file keep the old content. The file and its folder are
    synchronised with the disk.

    What is no regular file is not replaced: the bytes are written through a pipe, a character
    device or an open file (/dev/fd/3), and the path '-' stands for standard output. Block devices
    are refused.

    Raises ValueError if the folder cannot be made, or if the file cannot be written. Raises
    `ReaderGoneError` if nothing reads from a pipe any more.
    """
    try:
        found = _found(path)
        if found is None and not path.is_symlink():
            path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"{path.parent} cannot be written: {error.strerror or error}") from None
    try:
        if _is_stream(path, found):
            _write_through(path, data)
            return
        if found is not None:
            _require_permission(path, found)
        _replace(Path(os.path.realpath(path)), data, found)
    except BrokenPipeError:
        raise ReaderGoneError(f"nothing reads from {path} any more") from None
    except OSError as error:
        raise ValueError(f"{path} cannot be written: {error.strerror or error}") from None


def _found(path: Path) -> os.stat_result | None:
    """Return what is known of the file that a path leads to; None if there is none."""
    if path == OUTPUT:
        return None
    try:
        return path.stat()
    except FileNotFoundError:
        return None


def _require_permission(path: Path, found: os.stat_result) -> None:
    if stat.S_ISDIR(found.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if stat.S_ISBLK(found.st_mode):
        raise OSError(errno.ENOTSUP, "it is a block device")
    # To rename onto a file needs no permission of the file itself.
    if not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def _is_stream(path: Path, found: os.stat_result | None) -> bool:
    """Return whether a path leads to a pipe, a device, or a file that the process has open."""
    if path == OUTPUT or _open_file(path) is not None:
        return True
    return found is not None and not (
        stat.S_ISREG(found.st_mode) or stat.S_ISDIR(found.st_mode) or stat.S_ISBLK(found.st_mode)
    )


def _open_file(path: Path) -> int | None:
    """Return the number of the open file that a path such as /dev/stdout or /dev/fd/3 stands for.

    If that is a regular file, it is written from where the process stands in it, and not replaced.
    """
    # More symbolic links than these are an error of their own.
    for _ in range(40):
        folder = os.path.realpath(path.parent)
        if folder in (f"/proc/{os.getpid()}/fd", "/dev/fd") and path.name.isdecimal():
            return int(path.name)
        if not path.is_symlink():
            return None
        path = path.parent / path.readlink()
    return None


def _write_through(path: Path, data: bytes) -> None:
    if sys.stdout is not None:
        # What was printed before comes first.
        sys.stdout.flush()
    number = _STDOUT if path == OUTPUT else _open_file(path)
    # To open a pipe waits until something reads from it.
    handle = os.open(path, os.O_WRONLY | os.O_NOCTTY) if number is None else os.dup(number)
    try:
        _write_all(handle, data)
    finally:
        os.close(handle)


def _replace(path: Path, data: bytes, old: os.stat_result | None) -> None:
    temporary = path.parent / f".shadefit-{secrets.token_hex(8)}.partial"
    mode = 0o666 if old is None else stat.S_IMODE(old.st_mode) & 0o777
    with unfinished(temporary):
        try:
            handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
            try:
                if old is not None:
                    _keep(handle, old, mode)
                _write_all(handle, data)
                os.fsync(handle)
            finally:
                os.close(handle)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    _synchronise(path.parent)


def _keep(handle: int, old: os.stat_result, mode: int) -> None:
    """Give a new file the owner and the permissions of the one that it replaces."""
    new = os.fstat(handle)
    if (new.st_uid, new.st_gid) != (old.st_uid, old.st_gid):
        # Only the superuser can give a file to another user.
        with suppress(PermissionError):
            os.fchown(handle, old.st_uid, old.st_gid)
    os.fchmod(handle, mode)


def _write_all(handle: int, data: bytes) -> None:
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(handle, rest) :]


def _synchronise(folder: Path) -> None:
    """Write a folder's list of files to the disk, so that a new name survives a loss of power."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except PermissionError:
        # Files may be written into a folder that may not be listed.
        return
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in _NO_SYNC:
            raise
    finally:
        os.close(handle)
