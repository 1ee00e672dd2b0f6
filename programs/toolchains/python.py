"""Python with NumPy: the code runs in this process, in a namespace of its own."""

import sys
from typing import Any

import numpy as np

from programs.functions import Function, group_inputs
from programs.precision import number_type
from programs.toolchains.interface import compile_failure, run_failure
from programs.toolchains.process import ToolchainError

NOTE = "NumPy rounds every operation to the type of its arrays; whole arrays at a time."


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`. NumPy is always installed and has every precision."""
    return None


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`. Values whose type is not that of the precision are an error."""
    namespace: dict[str, Any] = {"__name__": "shadefit_exported"}
    kind = number_type(precision)
    grouped = group_inputs(function, [column.astype(kind) for column in inputs.T])
    arguments = [
        [each[k : k + 3] for k in range(0, len(each), 3)] if parameter.shape == "vectors" else each
        for parameter, each in zip(function.parameters, grouped, strict=True)
    ]
    try:
        exec(compile(source, f"<{function.name}>", "exec"), namespace)
    except Exception as error:
        log = f"{type(error).__name__}: {error}"
        raise ToolchainError(compile_failure("Python", function, precision), log) from error
    called = namespace.get(function.name)
    if not callable(called):
        log = f"the code defines no function {function.name}"
        raise ToolchainError(compile_failure("Python", function, precision), log)
    failure = run_failure("Python", function, precision)
    try:
        # Overflow shows in the values, so NumPy's warnings are not needed.
        with np.errstate(all="ignore"):
            given = called(*arguments)
        columns = [given] if function.result is None else list(given)
        if function.record is not None and function.record.vectors:
            columns = [each for three in columns for each in three]
    except Exception as error:
        raise ToolchainError(failure, f"{type(error).__name__}: {error}") from error
    for column in columns:
        if np.asarray(column).dtype != kind:
            raise ToolchainError(
                failure, f"values have type {np.asarray(column).dtype}, not {np.dtype(kind)}"
            )
    rows = len(inputs)
    return np.stack([np.broadcast_to(column, (rows,)) for column in columns], 1).astype(np.float64)


def versions() -> str:
    """See `Toolchain.versions`."""
    return f"Python {sys.version.split()[0]}, NumPy {np.__version__}"
