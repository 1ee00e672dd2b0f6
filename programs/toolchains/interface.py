"""What a toolchain is: whether it runs here, what it evaluates, what it is made of."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from programs.functions import Function, input_names
from programs.precision import number_type, rounded
from programs.toolchains.process import ToolchainError


@dataclass(frozen=True)
class Toolchain:
    """How one language is compiled and run on this machine.

    `missing_reason` gives None for a precision that it can run, else the reason; `evaluate` takes the
    source, the function, float64 inputs that the precision holds exactly, and the precision, and
    gives the values; `versions` says what compiles and what runs; `note` what a reader of the
    figures must know.
    """

    target: str
    missing_reason: Callable[[str], str | None]
    evaluate: Callable[[str, Function, np.ndarray, str], np.ndarray]
    versions: Callable[[], str]
    note: str

    @property
    def tool(self) -> str:
        """What compiles the code and what runs it, with versions."""
        return self.versions()

    def missing(self, precision: str) -> str | None:
        """None when code of this precision can be run here; else why not, in one line.

        Raises ValueError for an unknown precision.
        """
        number_type(precision)
        return self.missing_reason(precision)

    def run(
        self, source: str, function: Function, inputs: np.ndarray, precision: str
    ) -> np.ndarray:
        """Compile a function's code and evaluate it at every row of inputs.

        Arguments: `source`, the printed code; `function`, what it was printed from; `inputs`,
        (n, k) finite numbers, k = one a scalar parameter and `size` an array, in order;
        `precision`, "half", "float" or "double", to which the inputs are rounded first. Returns
        (n, m) float64, m = `function.result` or 1. Raises ValueError for inputs of another shape
        or range; ToolchainError when the toolchain is missing, or the code does not compile or
        run.
        """
        points = np.asarray(inputs, dtype=np.float64)
        width = len(input_names(function))
        if points.ndim != 2 or points.shape[0] < 1 or points.shape[1] != width:
            raise ValueError(
                f"inputs of {function.name} have shape {points.shape}; "
                f"allowed: (n, {width}) with n >= 1"
            )
        points = rounded(points, precision)
        reason = self.missing(precision)
        if reason is not None:
            raise ToolchainError(f"{self.target} in {precision} cannot be run here: {reason}")
        values = self.evaluate(source, function, points, precision)
        expected = (points.shape[0], result_count(function))
        if values.shape != expected:
            raise ToolchainError(
                f"{self.target} code of {function.name} gave values of shape {values.shape}, "
                f"not {expected}"
            )
        return values


def result_count(function: Function) -> int:
    """How many numbers one evaluation gives."""
    return 1 if function.result is None else function.result


def compile_failure(language: str, function: Function, precision: str) -> str:
    """Give the line that begins the error when a compiler refuses a function."""
    return f"{language} code of {function.name} in {precision} does not compile"


def run_failure(language: str, function: Function, precision: str) -> str:
    """Give the line that begins the error when a compiled function does not run to its end."""
    return f"{language} code of {function.name} in {precision} compiles but does not run"
