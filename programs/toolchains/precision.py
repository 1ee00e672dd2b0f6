"""The three precisions as NumPy sees them, and rounding to them."""

import numpy as np

from programs.languages.language import PRECISIONS


def number_type(precision: str) -> type[np.floating]:
    """NumPy's scalar type of a precision.

    Arguments: `precision`, one of "half", "float", "double". Raises ValueError for another name.
    """
    if precision not in PRECISIONS:
        raise ValueError(f"precision is {precision!r}; allowed: {', '.join(PRECISIONS)}")
    return PRECISIONS[precision]


def rounded(values: np.ndarray, precision: str) -> np.ndarray:
    """Round to the nearest number of a precision, ties to even, kept as float64.

    Arguments: `values`, any shape; `precision` as in `number_type`. Returns float64 of the same
    shape. Raises ValueError when a value is not finite, or too large for the precision.
    """
    if not np.isfinite(values).all():
        raise ValueError("inputs hold a value that is not finite; allowed: finite numbers")
    kind = number_type(precision)
    largest = float(np.finfo(kind).max)
    size = float(np.abs(values).max(initial=0.0))
    if size > largest:
        raise ValueError(f"inputs reach {size!r}; allowed in {precision}: at most {largest!r}")
    return values.astype(kind).astype(np.float64)
