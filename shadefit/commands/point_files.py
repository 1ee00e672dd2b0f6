"""Files of points at which a quantity is evaluated, and of the values there."""

import csv
import io
import math
from array import array
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from coefficients.input_files import read_bounded
from shadefit.commands.options import LEAST

if TYPE_CHECKING:
    import numpy as np

    from integrals.reference import Axis

# More points than these would not fit into memory with their values.
MAX_POINTS = 1 << 24
MAX_BYTES = 1 << 30
FORMATS = (".csv", ".npy")


def require_format(path: Path) -> str:
    """Return a path's extension. Raises ValueError for another one than .csv and .npy."""
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: allowed are files that end in {' or '.join(FORMATS)}")
    return path.suffix.lower()


def read_points(path: Path, axes: "Sequence[Axis]") -> "np.ndarray":
    """Return the points (n, axes) in a file, in the units of the axes: angles are in radians.

    A CSV file has a header with the names of the axes in any order, and may have other columns. An
    NPY file has an array (n, axes), or (n,) for one axis. Raises ValueError for a file that cannot
    be read as such, and for a point outside the domain.
    """
    import numpy as np

    extension = require_format(path)
    data = read_bounded(path, MAX_BYTES)
    points = _from_csv(path, data, axes) if extension == ".csv" else _from_npy(path, data, axes)
    if not 1 <= len(points) <= MAX_POINTS:
        raise ValueError(f"{path} has {len(points)} points: allowed are 1 to {MAX_POINTS}")
    for k, axis in enumerate(axes):
        # Compiled code takes a smaller number for 0.
        inside = axis.contains(np.where(np.abs(points[:, k]) < LEAST, 0.0, points[:, k]))
        if not inside.all():
            row = int((~inside).argmax())
            where = f"line {row + 2}" if extension == ".csv" else f"row {row}"
            unit = "" if axis.unit == "1" else f" {axis.unit}"
            value = f"{axis.name} = {points[row, k]:g}{unit}"
            raise ValueError(f"{path}, {where}: {value} is outside its domain {axis.domain}{unit}")
    return points


def written(columns: "Mapping[str, np.ndarray]", extension: str) -> bytes:
    """Return columns of numbers (n,) as the bytes of a file: '.csv' with a header, or '.npy'.

    An NPY file has an array (n,) whose fields have the names of the columns. Values that do not
    exist are nan.
    """
    if extension == ".csv":
        return csv_text(columns).encode()
    import numpy as np

    buffer = io.BytesIO()
    rows = np.empty(len(next(iter(columns.values()))), [(name, float) for name in columns])
    for name, values in columns.items():
        rows[name] = values
    np.save(buffer, rows, allow_pickle=False)
    return buffer.getvalue()


def csv_text(columns: "Mapping[str, np.ndarray]") -> str:
    """Return columns of numbers (n,) as CSV, with all digits needed to read them back exactly."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(columns)
    rows = zip(*(each.tolist() for each in columns.values()), strict=True)
    writer.writerows(map(repr, row) for row in rows)
    return buffer.getvalue()


def _from_csv(path: Path, data: bytes, axes: "Sequence[Axis]") -> "np.ndarray":
    import numpy as np

    try:
        # A byte order mark, which spreadsheets write, is not part of the first name.
        text = io.StringIO(data.decode("utf-8-sig").rstrip() + "\n", newline="")
        lines = csv.reader(text, strict=True)
        header = [name.strip() for name in next(lines)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{path} is no CSV file: {error}") from None
    places = []
    for axis in axes:
        names = {axis.name, axis.name.replace("_", "-"), axis.symbol, axis.alias}
        found = [k for k, name in enumerate(header) if name in names]
        if len(found) != 1:
            what = "no column" if not found else "several columns"
            wanted = ", ".join(each.name for each in axes)
            raise ValueError(f"{path} has {what} {axis.name}: its first line must name {wanted}")
        places += found
    # Eight bytes a number, as lists of a large file would not fit into memory
    numbers = array("d")
    try:
        for number, line in enumerate(lines, start=2):
            if len(line) != len(header):
                raise ValueError(
                    f"{path}, line {number} has {len(line)} cells: expected are {len(header)}"
                )
            if number > MAX_POINTS + 1:
                raise ValueError(f"{path} has too many points: allowed are 1 to {MAX_POINTS}")
            numbers.extend(_number(path, number, line[k]) for k in places)
    except csv.Error as error:
        raise ValueError(f"{path} is no CSV file: {error}") from None
    return np.array(numbers, float).reshape(-1, len(axes))


def _number(path: Path, line: int, text: str) -> float:
    try:
        # Python allows 1_000.
        value = math.nan if "_" in text else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{path}, line {line}: {text.strip()!r} is no finite number")
    return value


def _from_npy(path: Path, data: bytes, axes: "Sequence[Axis]") -> "np.ndarray":
    import numpy as np

    try:
        found = np.load(io.BytesIO(data), allow_pickle=False)
    # A broken header raises errors of many types.
    except Exception as error:
        reason = str(error).partition("\n")[0]
        raise ValueError(f"{path} is no NPY file: {reason}") from None
    if not isinstance(found, np.ndarray) or found.dtype.kind not in "fiu":
        raise ValueError(f"{path} has no array of numbers: expected is (points, {len(axes)})")
    if found.ndim == 1 and len(axes) == 1:
        found = found[:, None]
    if found.ndim != 2 or found.shape[1] != len(axes):
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(
            f"{path} has an array {found.shape}: expected is (points, {len(axes)}), for {names}"
        )
    return found.astype(float)
