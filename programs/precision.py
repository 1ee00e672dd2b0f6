"""The floating-point precisions that code can be written in, and rounding to them."""

import numpy as np

# Precision name -> the NumPy type with the same format. No other module lists these names.
PRECISIONS: dict[str, type[np.floating]] = {
    "half": np.float16,
    "float": np.float32,
    "double": np.float64,
}


def number_type(precision: str) -> type[np.floating]:
    """Return NumPy's scalar type of a precision.

    Arguments: `precision`, a key of PRECISIONS. Raises ValueError for any other name.
    """
    if precision not in PRECISIONS:
        raise ValueError(f"precision is {precision!r}; allowed: {', '.join(PRECISIONS)}")
    return PRECISIONS[precision]


def rounded(values: np.ndarray, precision: str) -> np.ndarray:
    """Round to the nearest number of a precision (ties to even); the result is still float64.

    Arguments: `values`, of any shape; `precision`, a key of PRECISIONS. Returns float64 of the same
    shape. Raises ValueError when a value is not finite or is too large for the precision.
    """
    if not np.isfinite(values).all():
        raise ValueError("inputs hold a value that is not finite; allowed: finite numbers")
    kind = number_type(precision)
    largest = float(np.finfo(kind).max)
    size = float(np.abs(values).max(initial=0.0))
    if size > largest:
        raise ValueError(f"inputs reach {size!r}; allowed in {precision}: at most {largest!r}")
    return values.astype(kind).astype(np.float64)
