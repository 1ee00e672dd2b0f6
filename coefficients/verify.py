"""Exported code held to the form it was printed from, and to the integral it stands for.

The code is compiled and run by its language's toolchain on a low-discrepancy set of points and on
the corners of the domain. The inputs are rounded to the precision; the float64 form gets the same
rounded inputs, so that this difference is the code's own. The integral is taken at the points as
they were, as the user of the code meets it.

What is allowed is set by the same operations, each correctly rounded to the precision in NumPy:
that is within half a unit in the last place an operation, while the languages grant theirs several.
To first order, an error of SLACK times half a unit in every operation gives SLACK times the error.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from coefficients.shaders import Shader
from fitting import exact_values
from fitting.points.grids import off_grid_points
from integrals import Axis
from programs.functions import Function
from programs.languages import PRECISIONS, target
from programs.printing.printer import write
from programs.program import evaluate
from programs.toolchains import ToolchainError
from programs.toolchains.registry import toolchain
from programs.tracing.tracer import trace

# Four units in the last place an operation, where NumPy has half a one.
SLACK = 8.0
# What is granted to functions whose every operation happens to be exact in NumPy: a few roundings.
LEAST_UNITS = 4.0
EXPONENT = 17
SEED = 20200718
# R has no closed form and is dear: it is compared at the first of the points only.
INTEGRAL_POINTS = {"r": 1 << 12}

Run = Callable[[Function, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Difference:
    """The largest and rms difference of the finite values from what they should be.

    `not_finite` counts the other values: near a pole, a denominator may be rounded to zero.
    """

    largest: float
    rms: float
    not_finite: int = 0

    def within(self, other: "Difference") -> bool:
        """Tell whether this is at most the other in every respect."""
        return (
            self.largest <= other.largest
            and self.rms <= other.rms
            and self.not_finite <= other.not_finite
        )


@dataclass(frozen=True)
class Check:
    """What came of one language: `status` is "passed", "failed" or "not checked".

    `reason` says why it is not "passed". `form` is the difference from the float64 form at the
    same rounded inputs, `units` the same in units in the last place of the form's value, `allowed`
    what `form` may be, `integral` the difference from the exact integral at `integral_points`.
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


class Problem:
    """A shader in a precision, with the points, and the values that its code should have there."""

    def __init__(self, shader: Shader, precision: str, exponent: int = EXPONENT):
        """Choose 2^exponent points and the corners; raises ValueError for an unknown precision."""
        if precision not in PRECISIONS:
            raise ValueError(f"precision is {precision!r}; allowed: {', '.join(PRECISIONS)}")
        self.shader, self.precision, self.exponent = shader, precision, exponent
        self.points = np.concatenate(
            [corners(shader.axes), off_grid_points(shader.axes, exponent, SEED)]
        )
        self.programs = {function.name: trace(function) for function in shader.functions}

    def values(self, run: Run) -> np.ndarray:
        """Call the functions one after the other at every point: (n,) float64."""
        dtype, results = PRECISIONS[self.precision], np.empty((len(self.points), 0))
        columns = self.shader.columns(self.points)
        for function, own in zip(self.shader.functions, columns, strict=True):
            # Zero keeps its sign and no cosine leaves its domain by being rounded.
            rows = np.concatenate([results, own.astype(dtype).astype(np.float64)], axis=1)
            # What is not finite stays so, whatever a compiler makes of it.
            finite = np.isfinite(rows).all(axis=1, keepdims=True)
            given = np.asarray(run(function, np.where(finite, rows, 0.0)), np.float64)
            results = np.where(finite, given, np.nan)
        return results[:, 0]

    def emulated(self, dtype: type[np.floating]) -> np.ndarray:
        """Evaluate in NumPy, every operation rounded to `dtype`: (n,)."""
        return self.values(lambda function, rows: evaluate(self._of(function), rows, dtype))

    @cached_property
    def form(self) -> np.ndarray:
        """The float64 form at the rounded inputs (n,)."""
        return self.emulated(np.float64)

    @cached_property
    def allowed(self) -> Difference:
        """The difference from the float64 form that code of this precision may have."""
        # In double, the form itself is rounded: there its error is float's, in double's units.
        double = self.precision == "double"
        judge = Problem(self.shader, "float", self.exponent) if double else self
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
        """The exact integral at the first of the points, which are the corners and some more."""
        name = self.shader.integral.name
        return exact_values(self.shader.integral, self.points[: INTEGRAL_POINTS.get(name)])

    def against_integral(self, values: np.ndarray) -> Difference:
        """Measure values (n,) against the exact integral."""
        return difference(values[: len(self.integral)], self.integral)

    def _of(self, function: Function):
        return self.programs[function.name]


def corners(axes: tuple[Axis, ...]) -> np.ndarray:
    """Give every combination of an axis's ends and middle, (3^axes, axes).

    Of an azimuth that goes all the way round: 0, π/2 and π, which differ.
    """
    lines = [
        (0.0, np.pi / 2, np.pi)
        if axis.upper - axis.lower > 2 * np.pi
        else (axis.lower, (axis.lower + axis.upper) / 2, axis.upper)
        for axis in axes
    ]
    return np.array(list(product(*lines)), np.float64)


def difference(
    values: np.ndarray, expected: np.ndarray, units: np.ndarray | None = None
) -> Difference:
    """Give the difference of values (n,) from finite ones, in `units` (n,) where there are some."""
    finite = np.isfinite(values)
    apart = np.abs(values[finite] - expected[finite])
    apart = apart if units is None else apart / units[finite]
    count = max(len(apart), 1)
    return Difference(
        float(np.max(apart, initial=0.0)),
        float(np.sqrt(np.sum(apart**2) / count)),
        int(np.sum(~finite)),
    )


def precision_of(language: str, wanted: str | None) -> str:
    """Give the precision that a language is written in by default, or the wanted one.

    Raises ValueError for an unknown language, and for a precision that it has not.
    """
    spelled = target(language)
    if wanted is None:
        return "float" if "float" in spelled.types else next(iter(spelled.types))
    if wanted not in spelled.types:
        raise ValueError(
            f"precision {wanted!r} is not in {spelled.name}; allowed: {', '.join(spelled.types)}"
        )
    return wanted


def run_code(problem: Problem, language: str, source: str) -> np.ndarray:
    """Compile and run the problem's code, printed in one language, at the points: values (n,).

    Raises ToolchainError for code that is refused or does not run.
    """
    chain, precision = toolchain(language), problem.precision
    return problem.values(lambda function, rows: chain.run(source, function, rows, precision))


def check(problem: Problem, language: str) -> Check:
    """Verify the code of one language in the problem's precision.

    Arguments: `problem`; `language`, a key of TARGETS. Returns the check. Raises ValueError for an
    unknown language.
    """
    precision = problem.precision
    spelled, chain = target(language), toolchain(language)
    if precision not in spelled.types:
        reason = f"{spelled.name} has no {precision} precision"
        return Check(language, precision, "not checked", reason)
    reason = chain.missing(precision)
    if reason is not None:
        return Check(language, precision, "not checked", reason)
    try:
        source = write(problem.shader.functions, language, precision)
    except ValueError as error:
        return Check(language, precision, "not checked", str(error))
    try:
        values = run_code(problem, language, source)
    except ToolchainError as error:
        return Check(language, precision, "failed", str(error), chain.tool, chain.note)
    apart = difference(values, problem.form)
    spacing = np.spacing(np.abs(problem.form).astype(PRECISIONS[precision])).astype(np.float64)
    passed = apart.within(problem.allowed)
    reason = None if passed else _why(apart, problem.allowed)
    return Check(
        language,
        precision,
        "passed" if passed else "failed",
        reason,
        chain.tool,
        chain.note,
        len(values),
        apart,
        difference(values, problem.form, spacing),
        problem.allowed,
        problem.against_integral(values),
        len(problem.integral),
    )


def _why(apart: Difference, allowed: Difference) -> str:
    return f"differs from the float64 form by {text_of(apart)}; allowed: {text_of(allowed)}"


def text_of(apart: Difference) -> str:
    """Write a difference with two digits: more would change with a compiler's version."""
    others = f", {apart.not_finite} values not finite" if apart.not_finite else ""
    return f"rms {apart.rms:.1e}, largest {apart.largest:.1e}{others}"
