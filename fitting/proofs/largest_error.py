"""The largest error of a form as a theorem: an upper bound on the whole domain, and a point near it.

The difference of a form and the exact value is one program, whose bounds are found by branch and
bound (`programs/bounding/largest.py`). This needs a closed form of the exact value.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fitting.form import FittedForm
from integrals.reference import Axis, box_of
from programs.bounding.compiled import Kernel, compile_kernel
from programs.bounding.interval_code import INTERVAL_C
from programs.bounding.largest import LargestValue, Standing, bound_largest
from programs.functions import Function, Parameter
from programs.printing.printer import write_source


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
    * `long`: whether the search is so long that the code should be compiled for speed.
    """

    parts: tuple[str, ...]
    box: np.ndarray
    to_axes: Callable[[np.ndarray], np.ndarray] = _unchanged
    from_axes: Callable[[np.ndarray], np.ndarray] = _unchanged
    inexact: float = 0.0
    roots_are_defined: bool = False
    long: bool = False

    def kernel(self) -> Kernel:
        """Compile the search."""
        return compile_kernel(self.parts, len(self.box), self.roots_are_defined, self.long)


@dataclass(frozen=True)
class LargestError:
    """The largest error: at least `lower`, attained at the point `at`, and nowhere above `upper`.

    `at` maps the names of axes to values. `boxes` is the number of boxes of the proof. `upper` is
    None if the search gave up near `at`.
    """

    lower: float
    at: dict[str, float]
    upper: float | None
    boxes: int


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
    code = printed(
        "difference", names, lambda *point: fitted.form(fitted.constants, *point) - exact(*point)
    )
    arguments = ", ".join(f"x[{k}]" for k in range(len(axes)))
    entry = f"static jet error_at(boxes *K, const jet *x) {{ return difference(K, {arguments}); }}"
    return ErrorCode((code, entry), box_of(axes), inexact=inexact)


def certify_largest_error(
    fitted: FittedForm,
    code: ErrorCode,
    ratio: float,
    seeds: np.ndarray,
    threads: int = 2,
    progress: Callable[[Standing], None] = lambda _: None,
) -> LargestError:
    """Bound the largest error of a form from both sides, the bounds about `ratio` apart.

    Arguments: `code` of the error; `ratio`, above 1; `seeds` (n, axes), points where the error may
    be large; `threads`; `progress`, which is called several times a second. Raises ValueError for
    another ratio, and ToolchainError without a compiler.
    """
    kernel, starts = code.kernel(), code.from_axes(seeds)
    found = bound_largest(
        kernel, code.box, ratio, seeds=starts, threads=threads, progress=progress
    )
    return _of_form(fitted, code, found)


def _of_form(fitted: FittedForm, code: ErrorCode, found: LargestValue) -> LargestError:
    (point,) = code.to_axes(np.array([found.at]))
    at = {axis.name: float(x) for axis, x in zip(fitted.axes, point, strict=True)}
    upper = None if found.upper is None else float(np.nextafter(found.upper + code.inexact, np.inf))
    return LargestError(max(found.lower - code.inexact, 0.0), at, upper, found.boxes)
