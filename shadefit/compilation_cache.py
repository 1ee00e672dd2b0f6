"""The cache of compiled programs, which JAX keeps in the user's own cache folder between commands.

What JAX compiled is machine code, and is run as it is read. So it is only read from a folder that
nobody else can write into: the folder belongs to the user and has mode 700, and each folder above
it belongs to the user or to root, and lets others write only if it is sticky, as /tmp is. Another
folder is not repaired but left alone; commands then compile as if there were no cache. Two commands
may write at a time: an entry that is incomplete fails its checksum, and is compiled instead.
"""

import hashlib
import os
import stat
import sys
import warnings
from collections.abc import MutableMapping
from importlib.metadata import version
from pathlib import Path

# The variable has 'off', or the folder to use in place of the user's cache folder.
VARIABLE = "SHADEFIT_CACHE"
OFF = "off"
# The oldest entries are removed beyond this size, down to half of it.
MOST_BYTES = 256 << 20
_PRIVATE = 0o700
# JAX keeps what took at least a second to compile, unless it is told otherwise.
_SETTINGS = {
    "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
    "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "0",
    "JAX_PERSISTENT_CACHE_ENABLE_XLA_CACHES": "none",
}
_FOLDER = "JAX_COMPILATION_CACHE_DIR"


def use_cache(environment: MutableMapping[str, str] = os.environ) -> Path | None:
    """Let JAX, which is not imported yet, use the cache. Returns its folder; None if there is none.

    There is none if the variable `SHADEFIT_CACHE` is 'off', if the folder cannot be made or is not
    safe, and where files have no owner (Windows). A folder in JAX's own variable is left as it is.
    """
    root = cache_root(environment)
    if root is None or _FOLDER in environment:
        return None
    folder = _made(root / _machine())
    if folder is None:
        return None
    _trim(folder.parent)
    environment.update({_FOLDER: str(folder), **_SETTINGS})
    # An entry that cannot be read or written costs time only. It is no message for the user.
    warnings.filterwarnings("ignore", message="Error (reading|writing) persistent compilation")
    return folder


def cache_root(environment: MutableMapping[str, str]) -> Path | None:
    """Return the absolute folder of all machines' caches; None if there is to be none."""
    given = environment.get(VARIABLE, "")
    if given == OFF or not hasattr(os, "geteuid"):
        return None
    if given:
        return Path(given).absolute()
    base = environment.get("XDG_CACHE_HOME", "")
    if os.path.isabs(base):
        return Path(base) / "shadefit" / "compiled"
    home = environment.get("HOME", "")
    if not os.path.isabs(home):
        return None
    usual = ("Library", "Caches") if sys.platform == "darwin" else (".cache",)
    return Path(home, *usual, "shadefit", "compiled")


def is_safe(folder: Path) -> bool:
    """Whether nobody but the user and root can change what is in an existing folder."""
    place = Path(os.path.realpath(folder))
    try:
        own = place.lstat()
        above = [each.lstat() for each in place.parents]
    except OSError:
        return False
    user = os.geteuid()
    if own.st_uid != user or stat.S_IMODE(own.st_mode) != _PRIVATE or not stat.S_ISDIR(own.st_mode):
        return False
    return all(
        each.st_uid in (0, user) and (not each.st_mode & 0o022 or each.st_mode & stat.S_ISVTX)
        for each in above
    )


def _made(folder: Path) -> Path | None:
    """Make a folder, and those above it, for the user alone; None if it is not safe or not made."""
    try:
        for each in [*reversed(folder.parents), folder]:
            if not each.exists():
                each.mkdir(_PRIVATE, exist_ok=True)
    except OSError:
        return None
    safe = is_safe(folder) and os.access(folder, os.R_OK | os.W_OK | os.X_OK)
    return Path(os.path.realpath(folder)) if safe else None


def _machine() -> str:
    """Return a name for what compiled code depends on: the processor and the compiler.

    The cache may be in a home folder that several machines share.
    """
    system = os.uname()
    processor = [system.sysname, system.machine]
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        lines = []
    for key in ("model name", "flags", "Features", "CPU part"):
        processor += [line for line in lines if line.split("\t")[0].strip(": ") == key][:1]
    text = "\n".join([version("jax"), version("jaxlib"), *processor])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _trim(root: Path) -> None:
    """Remove the oldest entries of all machines if they are larger than `MOST_BYTES` together."""
    try:
        entries = [each for each in root.glob("*/*") if each.is_file()]
        known = sorted((each.stat().st_mtime, each.stat().st_size, each) for each in entries)
    except OSError:
        return
    size = sum(each for _, each, _ in known)
    if size <= MOST_BYTES:
        return
    for _, each, path in known:
        if size <= MOST_BYTES // 2:
            break
        try:
            path.unlink(missing_ok=True)
        except OSError:
            return
        size -= each
