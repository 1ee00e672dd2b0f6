"""Measured or tabulated values as a source: `table` reads a file, `samples` takes arrays."""

import csv
import hashlib
import io
import math
import sys
import zipfile
from array import array
from collections.abc import Sequence
from contextvars import ContextVar
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Shaped

# A larger file is refused before it is read.
MAX_BYTES = 1 << 30
# An archive may unpack to so many bytes, or to so many times its own size. Measured numbers do not
# become much smaller, but a small file of zeros could fill the memory.
_UNPACKED, _TIMES = 1 << 28, 8
_SEED = 20200901
# The squares of larger numbers, and their sums, overflow.
_LARGEST = 1e150
# The folder of the problem file that is being loaded.
PROBLEM_FOLDER: ContextVar[Path | None] = ContextVar("PROBLEM_FOLDER", default=None)


@dataclass(frozen=True, eq=False)
class Data:
    """Points (n, axes) with their values (n,).

    * `sigma` (n,): standard deviations of the values; None: all values weigh the same.
    * `held_out` (n,): the rows that no fit uses. They judge the fits. If there are none, all rows
      are fitted and judge too.
    * `source`: the file's name, or 'arrays'. `digest`: the SHA-256 of the file, or of the numbers.
    """

    points: Float[np.ndarray, "n axes"]
    values: Float[np.ndarray, " n"]
    sigma: Float[np.ndarray, " n"] | None
    held_out: Shaped[np.ndarray, " n"]
    source: str
    digest: str

    @property
    def fitted(self) -> np.ndarray:
        """The numbers of the rows that fits use."""
        return np.flatnonzero(~self.held_out)

    @property
    def judging(self) -> np.ndarray:
        """The numbers of the rows that judge fits: those held out, or all if there are none."""
        return np.flatnonzero(self.held_out) if self.held_out.any() else np.arange(len(self.values))

    def weights(self, rows: np.ndarray) -> np.ndarray:
        """Return the numbers that errors at some rows are multiplied by: least σ over own σ."""
        if self.sigma is None:
            return np.ones(len(rows))
        return self.sigma.min() / self.sigma[rows]


def samples(points: Any, values: Any, sigma: Any = None, hold_out: int = 0) -> Data:
    """Return data from arrays.

    Arguments: `points` (n, axes), or (n,) for one axis, or a tuple of one array (n,) for each axis;
    `values` (n,); `sigma`, standard deviations (n,) or one for all; `hold_out`, 0 or a number k:
    one row of k, chosen at random but always the same, is kept from the fits and judges them.
    Raises ValueError for numbers that are not finite, shapes that differ, and σ ≤ 0.
    """
    if isinstance(points, tuple):
        points = np.stack([np.asarray(each, float).ravel() for each in points], axis=1)
    x = np.asarray(points, float)
    x = x[:, None] if x.ndim == 1 else x
    y = np.asarray(values, float)
    if x.ndim != 2 or y.shape != (len(x),) or not len(y):
        raise ValueError(
            f"points of shape {x.shape} and values of shape {y.shape}: "
            "expected are (n, axes) and (n,)"
        )
    spread = None
    if sigma is not None:
        spread = np.broadcast_to(np.asarray(sigma, float), y.shape).copy()
        _require(np.isfinite(spread) & (spread > 0), "sigma", spread, "a positive number")
    for name, column in (("the value", y), *((f"axis {k + 1}", c) for k, c in enumerate(x.T))):
        good = np.abs(column) <= _LARGEST
        _require(good, name, column, f"a finite number, at most {_LARGEST:g} in size")
    numbers = np.column_stack([x, y, *([] if spread is None else [spread])])
    digest = hashlib.sha256(numbers.tobytes()).hexdigest()
    return Data(x, y, spread, _chosen(len(y), hold_out), "arrays", digest)


def table(
    file: str | Path, x: Sequence[str], y: str, sigma: str | None = None, hold_out: int = 0
) -> Data:
    """Read data from a file of columns: CSV with a header line, NPY, or NPZ.

    Arguments: `x`, the names of the columns of the axes, in the axes' order; `y`, that of the
    values; `sigma`, that of the standard deviations; `hold_out` as for `samples`. An NPY file holds
    a structured array, or an array (n, columns) whose columns are named '0', '1', …; an NPZ file
    one array (n,) for each name. A relative path starts at the folder of the problem file that is
    loaded, or of the script that runs, if the file is there; else at the working folder. Raises
    ValueError for a file that cannot be read, a column that it does not have, and a number that is
    not finite, with its row.
    """
    path = _located(Path(file))
    content = _content(path)
    columns = _READERS[path.suffix.lower()](content, path)
    wanted = [*x, y, *([sigma] if sigma else [])]
    for name in wanted:
        if name not in columns:
            raise ValueError(f"{path} has no column {name!r}: allowed are {', '.join(columns)}")
    used = [columns[name] for name in wanted]
    if len({len(each) for each in used}) > 1:
        raise ValueError(f"{path} has columns of different lengths")
    for name, column in zip(wanted, used, strict=True):
        _require(np.isfinite(column), f"{path}: {name}", column, "a finite number")
    try:
        found = samples(tuple(used[: len(x)]), used[len(x)], used[-1] if sigma else None, hold_out)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return replace(found, source=path.name, digest=hashlib.sha256(content).hexdigest())


def _located(path: Path) -> Path:
    script = getattr(sys.modules["__main__"], "__file__", None)
    folder = PROBLEM_FOLDER.get() or (Path(script).parent if script else Path())
    return folder / path if (folder / path).is_file() else path


def _content(path: Path) -> bytes:
    if path.suffix.lower() not in _READERS:
        raise ValueError(f"{path} is no data: allowed are files {', '.join(_READERS)}")
    try:
        # Pipes and devices may never end.
        if not path.is_file():
            raise ValueError(f"{path}: no such file")
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    if len(content) > MAX_BYTES:
        raise ValueError(f"{path} is larger than {MAX_BYTES >> 20} MiB")
    return content


def _csv(content: bytes, path: Path) -> dict[str, np.ndarray]:
    """Read a CSV file: a header line, then numbers. Lines that begin with # are comments."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no UTF-8 text") from None
    names: list[str] = []
    # Eight bytes a number, as lists of a large file would not fit into memory
    numbers = array("d")
    try:
        for number, row in enumerate(csv.reader(io.StringIO(text), skipinitialspace=True), 1):
            if not row or row[0].startswith("#"):
                continue
            if not names:
                names = [name.strip() for name in row]
                continue
            if len(row) != len(names):
                raise ValueError(
                    f"{path}:{number} has {len(row)} fields, the header has {len(names)}; commas "
                    "separate them"
                )
            numbers.extend(map(_number, row))
    except csv.Error as error:
        raise ValueError(f"{path} is no CSV file: {error}") from None
    if not numbers:
        raise ValueError(f"{path} has no rows: expected are a header line and lines of numbers")
    if len(set(names)) < len(names):
        raise ValueError(f"{path} has two columns of one name: {', '.join(names)}")
    return dict(zip(names, np.array(numbers).reshape(-1, len(names)).T, strict=True))


def _number(field: str) -> float:
    """Return a field as a number. Text gives NaN, so that a column that is not used may hold it."""
    try:
        # Python allows 1_000.
        return math.nan if "_" in field else float(field)
    except ValueError:
        return math.nan


def _npy(content: bytes, path: Path) -> dict[str, np.ndarray]:
    found = _array(io.BytesIO(content), path)
    if found.dtype.names:
        return {name: _numbers(found[name], path) for name in found.dtype.names}
    if found.ndim != 2:
        raise ValueError(f"{path} has shape {found.shape}: expected is (n, columns)")
    return {str(k): _numbers(column, path) for k, column in enumerate(found.T)}


def _npz(content: bytes, path: Path) -> dict[str, np.ndarray]:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            allowed = min(MAX_BYTES, max(_UNPACKED, _TIMES * len(content)))
            if sum(each.file_size for each in archive.infolist()) > allowed:
                raise ValueError(f"{path} unpacks to more than {allowed >> 20} MiB")
            return {
                each.removesuffix(".npy"): _numbers(
                    _array(io.BytesIO(archive.read(each)), path).ravel(), path
                )
                for each in archive.namelist()
            }
    except ValueError:
        raise
    # Broken, encrypted or unknown compression raises errors of many types.
    except Exception:
        raise ValueError(f"{path} is no NPZ file") from None


def _array(stream: io.BytesIO, path: Path) -> np.ndarray:
    try:
        return np.lib.format.read_array(stream, allow_pickle=False)
    # A broken header raises errors of many types.
    except Exception:
        raise ValueError(f"{path} is no NPY data without Python objects") from None


def _numbers(found: np.ndarray, path: Path) -> np.ndarray:
    if found.dtype.kind not in "fiub":
        raise ValueError(f"{path} has an array of {found.dtype}: expected are real numbers")
    return found.astype(float)


def _require(good: np.ndarray, name: str, column: np.ndarray, allowed: str) -> None:
    for row in np.flatnonzero(~good)[:1]:
        raise ValueError(f"{name} of row {row + 1} is {column[row]:g}: allowed is {allowed}")


def _chosen(count: int, hold_out: int) -> np.ndarray:
    """Return a mask (count,) of the rows to hold out."""
    if hold_out != 0 and not 2 <= hold_out <= count:
        raise ValueError(f"hold_out = {hold_out}: allowed are 0 and 2 to {count}, the rows")
    mask = np.zeros(count, bool)
    if hold_out:
        mask[np.random.default_rng(_SEED).permutation(count)[: count // hold_out]] = True
    return mask


_READERS = {".csv": _csv, ".npy": _npy, ".npz": _npz}
