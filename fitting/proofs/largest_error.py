"""The largest error of a form as a theorem: a bound on the whole domain, and a point near it.

The difference of a form and the exact value is one program, whose bounds are found by branch and
bound (`programs/bounding/largest.py`). This needs a closed form of the exact value.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fitting.form import FittedForm, traced
from integrals.reference import Axis, box_of
from programs.bounding.compiled import Kernel, compile_kernel, compiler_missing
from programs.bounding.denominators import prove_no_pole
from programs.bounding.interval_code import INTERVAL_C
from programs.bounding.largest import LargestValue, Report, bound_largest, bound_largest_slowly
from programs.functions import Function, Parameter
from programs.printing.printer import write_source
from programs.program import Program
from programs.toolchains.process import ToolchainError

# A positive bound of denominators that need not be improved
ENOUGH = 1e-6


def _unchanged(points: np.ndarray) -> np.ndarray:
    return points


@dataclass(frozen=True)
class ErrorCode:
    """The error of a form as C code for the search.

    * `parts`: code in interval arithmetic, of which the last part defines `error_at`.
    * `box`: the ends (sides, 2) of the variables of the code.
    * `to_axes`, `from_axes`: map points (n, sides) of the box to points of the form's axes, and
      back.
    * `inexact`: a bound of the difference between the closed form in the code, in exact arithmetic,
      and the exact value. It contains what its constants and series leave out.
    * `roots_are_defined`: whether it is proven that no radicand is negative.
    * `program`: the same as a program, if it is one.
    * `long`: whether the search is so long that the code should be compiled for speed.
    """

    parts: tuple[str, ...]
    box: np.ndarray
    to_axes: Callable[[np.ndarray], np.ndarray] = _unchanged
    from_axes: Callable[[np.ndarray], np.ndarray] = _unchanged
    inexact: float = 0.0
    roots_are_defined: bool = False
    long: bool = False
    program: Program | None = None

    def kernel(self) -> Kernel:
        """Compile the search."""
        return compile_kernel(self.parts, len(self.box), self.roots_are_defined, self.long)


@dataclass(frozen=True)
class LargestError:
    """The largest error: at least `lower`, attained at the point `at`, and nowhere above `upper`.

    `at` maps the names of axes to values. `boxes` is the number of boxes of the proof. `upper` is
    None if the search gave up near `at`, or if the error at `at` refutes a claim.
    """

    lower: float
    at: dict[str, float]
    upper: float | None
    boxes: int
    refuted: bool = False


def printed(name: str, inputs: tuple[str, ...], call: Callable, results: int | None = None) -> str:
    """Write a JAX function of scalars as code in interval arithmetic."""
    parameters = tuple(Parameter(each, (-1.0, 1.0)) for each in inputs)
    function = Function(name, f"{name}.", parameters, results, "results", call)
    return write_source(function, INTERVAL_C, "double")


def difference_code(
    fitted: FittedForm, exact: Callable, inexact: float, axes: tuple[Axis, ...] | None = None
) -> ErrorCode:
    """Return the code of a form's difference from an exact value, a function of the axes.

    `exact` is traced, so it must consist of known operations; `inexact` is a bound of what it
    leaves out. Raises ValueError for an operation that is not known.
    """
    axes = fitted.axes if axes is None else axes
    names = tuple(f"x{k}" for k in range(len(axes)))

    def difference(*point):
        return fitted.form(fitted.constants, *point) - exact(*point)

    code, program = printed("difference", names, difference), traced(fitted, difference, axes)
    arguments = ", ".join(f"x[{k}]" for k in range(len(axes)))
    entry = f"static jet error_at(boxes *K, const jet *x) {{ return difference(K, {arguments}); }}"
    return ErrorCode((code, entry), box_of(axes), inexact=inexact, program=program)


def certify_largest_error(
    fitted: FittedForm,
    code: ErrorCode,
    ratio: float,
    seeds: np.ndarray,
    *,
    claim: float | None = None,
    threads: int = 2,
    progress: Report = lambda _: None,
) -> LargestError:
    """Bound the largest error of a form from both sides, the bounds about `ratio` apart.

    Arguments: `code` of the error; `ratio`, above 1; `seeds` (n, axes), points where the error may
    be large; `claim`, a bound to prove or to refute instead; `threads`; `progress`, which is called
    several times a second. Without a compiler, a slow search in Python tries the same if the code
    has a `program`. Raises ValueError for another ratio, and without compiler and program.
    """
    starts = code.from_axes(seeds)
    reason = compiler_missing()
    if reason is not None:
        if code.program is None or claim is not None:
            raise ValueError(f"the proof needs a C compiler: {reason}")
        slow = bound_largest_slowly(code.program, code.box, ratio, seeds=starts)
        return _of_form(fitted, code, slow)
    try:
        kernel = code.kernel()
    except ToolchainError as error:
        raise ValueError(f"{error.summary}: allowed is gcc or a compiler like it") from error
    if claim is not None:
        claim -= code.inexact

    def search(kernel: Kernel) -> LargestValue:
        return bound_largest(
            kernel,
            code.box,
            ratio,
            claim=claim,
            inexact=code.inexact,
            seeds=starts,
            threads=threads,
            progress=progress,
        )

    found = search(kernel)
    refuted = claim is not None and found.lower > claim + 2 * code.inexact
    gave_up = found.upper is None and not refuted and code.program is not None
    # Rounding may make the bounds of a radicand negative that is zero on the boundary.
    if gave_up and prove_no_pole(code.program, code.box, ENOUGH).holds:
        found = search(replace(code, roots_are_defined=True).kernel())
    return _of_form(fitted, code, found, refuted)


def _of_form(
    fitted: FittedForm, code: ErrorCode, found: LargestValue, refuted: bool = False
) -> LargestError:
    (point,) = code.to_axes(np.array([found.at]))
    at = {axis.name: float(x) for axis, x in zip(fitted.axes, point, strict=True)}
    upper = None if found.upper is None else float(np.nextafter(found.upper + code.inexact, np.inf))
    return LargestError(max(found.lower - code.inexact, 0.0), at, upper, found.boxes, refuted)
