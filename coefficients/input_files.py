"""Reading files that may be hostile: regular files of a limited size, without waiting."""

import os
import stat
from pathlib import Path


def read_bounded(path: Path, limit: int) -> bytes:
    """Return the bytes of a regular file that has at most `limit` of them.

    Pipes and devices may never end, and are refused. Raises ValueError in one line that names the
    path.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise ValueError(f"{path}: it is no regular file, as a folder, a pipe or a device")
        # If a pipe has taken the file's place by now, to open it does not wait for a writer.
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        with open(handle, "rb") as file:
            size = os.fstat(handle).st_size
            # Files of /proc state no size. A file may grow while it is read.
            data = file.read(limit + 1) if size <= limit else b""
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}") from None
    if max(size, len(data)) > limit:
        raise ValueError(f"{path} has {max(size, len(data))} bytes: allowed are {limit}")
    return data
