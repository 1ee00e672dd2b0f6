"""Verification of exported code: against the program it was printed from, and against exact values.

The code is compiled and run by its language's toolchain at given points. The inputs are rounded to
the precision, and the float64 program gets the same rounded inputs, so that their difference is due
to the code alone. Exact values are taken at the points before rounding, as a user of the code would
compare them.

The allowed difference is set by evaluating the same operations in NumPy, each correctly rounded to
the precision. NumPy's error is at most half a unit in the last place for each operation, while
languages allow several units. To first order, errors that are SLACK times as large in every
operation give a difference that is SLACK times as large.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Protocol, runtime_checkable

import numpy as np

from programs.functions import Function
from programs.languages import PRECISIONS, language
from programs.precision import number_type
from programs.printing.printer import write_source
from programs.program import Program, evaluate
from programs.toolchains.difference import Difference, difference, text_of
from programs.toolchains.half_precision import verdict
from programs.toolchains.interface import result_count
from programs.toolchains.process import ToolchainError
from programs.toolchains.registry import toolchain
from programs.tracing.tracer import trace

# Languages are allowed four units in the last place for an operation, where NumPy has half a unit.
SLACK = 8.0
# In units in the last place: allowed even if every operation happens to be exact in NumPy.
LEAST_UNITS = 4.0

# Evaluates one function at rows of inputs (n, k): values (n, m)
Run = Callable[[Function, np.ndarray], np.ndarray]


@runtime_checkable
class DomainAxis(Protocol):
    """One side of a domain, as far as `corners` needs to know it; `period` is None or a number."""

    @property
    def lower(self) -> float:
        """The lower end."""
        ...

    @property
    def upper(self) -> float:
        """The upper end."""
        ...

    @property
    def period(self) -> float | None:
        """The period of all functions on the axis, or None."""
        ...


@dataclass(frozen=True)
class CallSequence:
    """Functions that are called one after the other to evaluate a quantity at a point.

    The first function takes its own arguments. Each other function takes the results of the one
    before it, followed by its own arguments. The last returns the value, or several values that are
    compared one by one. `columns(points)` returns the own arguments of each function, one array
    (n, k) for each, at points (n, axes).
    """

    functions: tuple[Function, ...]
    columns: Callable[[np.ndarray], tuple[np.ndarray, ...]]

    @property
    def results(self) -> int:
        """The number of values at a point."""
        return result_count(self.functions[-1])


@dataclass(frozen=True)
class Check:
    """The result of verifying one language.

    `status` is "passed", "failed", "not checked" or, only in half precision, "not good enough": the
    code is right, but its rounding moves values too far (`half_precision.verdict`). `reason` says
    why the status is not "passed". `form` is the difference from the float64 program at the same
    rounded inputs, `units` the same in units in the last place of the program's value, and
    `allowed` the largest `form` that passes. `integral` is the difference from the exact values at
    `integral_points` points, or None if there are no exact values.
    """

    language: str
    precision: str
    status: str
    reason: str | None = None
    tool: str | None = None
    note: str | None = None
    points: int = 0
    form: Difference | None = None
    units: Difference | None = None
    allowed: Difference | None = None
    integral: Difference | None = None
    integral_points: int = 0


@dataclass(frozen=True, eq=False)
class Trial:
    """Functions to verify in one precision, the points, and the values expected at these points.

    `points` are (n, axes). Functions with m values at a point give m·n values, in the order of the
    points. `exact` returns the exact values (k,) or (k, m) at points (k, axes), or is None if
    they are not known. If it is slow, `exact_points` limits it to the first points. Raises
    ValueError for an unknown precision and for a function that cannot be traced.
    """

    calls: CallSequence
    points: np.ndarray
    precision: str
    exact: Callable[[np.ndarray], np.ndarray] | None = None
    exact_points: int | None = None

    def __post_init__(self):
        number_type(self.precision)
        # Trace now, so that a function that cannot be traced is an error at once.
        _ = self.programs

    @cached_property
    def programs(self) -> dict[str, Program]:
        """The program of each function, by the function's name."""
        return {function.name: trace(function) for function in self.calls.functions}

    def values(self, run: Run) -> np.ndarray:
        """Call the functions one after the other at every point; returns (n·m,) float64."""
        return self.values_at(self.points, run)

    def values_at(self, points: np.ndarray, run: Run) -> np.ndarray:
        """Call the functions one after the other at other points; returns (n·m,) float64."""
        dtype, results = PRECISIONS[self.precision], np.empty((len(points), 0))
        columns = self.calls.columns(points)
        for function, own in zip(self.calls.functions, columns, strict=True):
            # Rounding moves no cosine out of its domain, and keeps the sign of a zero.
            rows = np.concatenate([results, own.astype(dtype).astype(np.float64)], axis=1)
            # A row with a value that is not finite is not run: it depends on the compiler what code
            # makes of such a value. The result is NaN.
            finite = np.isfinite(rows).all(axis=1, keepdims=True)
            given = np.asarray(run(function, np.where(finite, rows, 0.0)), np.float64)
            results = np.where(finite, given, np.nan)
        return results.reshape(-1)

    def emulated(self, dtype: type[np.floating]) -> np.ndarray:
        """Evaluate the programs in NumPy, every operation rounded to `dtype`; returns (n·m,)."""
        return self.emulated_at(self.points, dtype)

    def emulated_at(self, points: np.ndarray, dtype: type[np.floating]) -> np.ndarray:
        """Evaluate the programs as `emulated` does, at other points."""
        return self.values_at(
            points, lambda function, rows: evaluate(self.programs[function.name], rows, dtype)
        )

    @cached_property
    def form(self) -> np.ndarray:
        """The values (n·m,) of the float64 programs at the rounded inputs."""
        return self.emulated(np.float64)

    @cached_property
    def allowed(self) -> Difference:
        """The difference from `form` that code of this precision may have."""
        # In double the float64 program is rounded too and cannot be the reference. Take the error
        # in float instead, scaled to units of double.
        double = self.precision == "double"
        judge = replace(self, precision="float") if double else self
        dtype, own = PRECISIONS[judge.precision], np.finfo(PRECISIONS[self.precision]).eps
        rounding = difference(judge.emulated(dtype), judge.form)
        slack = SLACK * float(own / np.finfo(dtype).eps)
        least = LEAST_UNITS * float(own) * float(np.max(np.abs(self.form)))
        return Difference(
            max(slack * rounding.largest, least),
            max(slack * rounding.rms, least),
            int(SLACK * rounding.not_finite),
        )

    @cached_property
    def integral(self) -> np.ndarray:
        """The exact values at the first `exact_points` points; raises ValueError without any."""
        if self.exact is None:
            raise ValueError("exact is None; allowed here: a function that returns exact values")
        return self.exact(self.points[: self.exact_points]).reshape(-1)

    @property
    def integral_points(self) -> int:
        """The number of points at which exact values are taken."""
        return len(self.integral) // self.calls.results

    def against_integral(self, values: np.ndarray) -> Difference:
        """Return the difference of values (n·m,) from the exact values, where these are known."""
        return difference(values[: len(self.integral)], self.integral)


def corners(axes: Sequence[DomainAxis]) -> np.ndarray:
    """Return all combinations of the ends and the middle of each axis, (3^axes, axes).

    The ends of a periodic axis are the same point. For such an axis, which is an angle, 0, π/2 and
    π are taken.
    """
    lines = [
        (0.0, np.pi / 2, np.pi)
        if axis.period is not None
        else (axis.lower, (axis.lower + axis.upper) / 2, axis.upper)
        for axis in axes
    ]
    return np.array(list(product(*lines)), np.float64)


def run_code(trial: Trial, key: str, source: str) -> np.ndarray:
    """Compile and run the code of a trial's functions, in the language `key`: (n·m,) values.

    Raises ToolchainError when the code does not compile or run.
    """
    chain, precision = toolchain(key), trial.precision
    return trial.values(lambda function, rows: chain.run(source, function, rows, precision))


def check(trial: Trial, key: str) -> Check:
    """Print, compile, run and compare the functions of a trial in one language.

    Arguments: `key`, a key of LANGUAGES. Returns the result. Raises ValueError for an unknown
    language.
    """
    precision = trial.precision
    spelled, chain = language(key), toolchain(key)
    if precision not in spelled.types:
        reason = f"{spelled.name} has no {precision} precision"
        return Check(key, precision, "not checked", reason)
    reason = chain.missing(precision)
    if reason is not None:
        return Check(key, precision, "not checked", reason)
    try:
        source = write_source(trial.calls.functions, key, precision)
    except ValueError as error:
        return Check(key, precision, "not checked", str(error))
    try:
        values = run_code(trial, key, source)
    except ToolchainError as error:
        return Check(key, precision, "failed", str(error), chain.tool, chain.note)
    apart = difference(values, trial.form)
    # Components of a vector are compared in units of the largest one at their point.
    sizes = np.abs(trial.form).reshape(-1, trial.calls.results)
    sizes = np.broadcast_to(sizes.max(axis=1, keepdims=True), sizes.shape).reshape(-1)
    spacing = np.spacing(sizes.astype(PRECISIONS[precision])).astype(np.float64)
    passed = apart.within(trial.allowed)
    known = trial.exact is not None
    status, why = "passed" if passed else "failed", None
    if not passed:
        why = _why_failed(apart, trial.allowed)
    elif precision == "half":
        good, said = verdict(trial, apart)
        status, why = ("passed", None) if good else ("not good enough", said)
    return Check(
        key,
        precision,
        status,
        why,
        chain.tool,
        chain.note,
        len(trial.points),
        apart,
        difference(values, trial.form, spacing),
        trial.allowed,
        trial.against_integral(values) if known else None,
        trial.integral_points if known else 0,
    )


def _why_failed(apart: Difference, allowed: Difference) -> str:
    return f"differs from the float64 form by {text_of(apart)}; allowed: {text_of(allowed)}"
