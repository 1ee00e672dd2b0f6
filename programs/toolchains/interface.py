"""What a toolchain is, and the texts that all toolchains share."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from programs.functions import Function, input_names
from programs.precision import number_type, rounded
from programs.toolchains.process import ToolchainError


@dataclass(frozen=True)
class Toolchain:
    """How the code of one language is compiled and run on this machine.

    `language` is the key of the language. `missing_reason(precision)` returns None if code of that
    precision can be run here, else the reason. `evaluate(source, function, inputs, precision)`
    returns the values at the inputs, which are float64 numbers that the precision holds exactly.
    `versions()` names the compiler and the machine that runs the code. `note` is what a reader of
    the results must know.
    """

    language: str
    missing_reason: Callable[[str], str | None]
    evaluate: Callable[[str, Function, np.ndarray, str], np.ndarray]
    versions: Callable[[], str]
    note: str

    @property
    def tool(self) -> str:
        """The compiler and the machine that runs the code, with versions."""
        return self.versions()

    def missing(self, precision: str) -> str | None:
        """Return None if code of this precision can be run here, else the reason in one line.

        Raises ValueError for an unknown precision.
        """
        number_type(precision)
        return self.missing_reason(precision)

    def run(
        self, source: str, function: Function, inputs: np.ndarray, precision: str
    ) -> np.ndarray:
        """Compile the code of a function and evaluate it at every row of inputs.

        Arguments: `source`, the printed code; `function`, which it was printed from; `inputs`
        (n, k), finite numbers, with one column for each of `input_names(function)`; `precision`, to
        which the inputs are rounded first. Returns (n, m) float64, where m is `function.result` or
        1. Raises ValueError for inputs of another shape or out of range, and ToolchainError when
        the toolchain is missing or the code does not compile or run.
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
            raise ToolchainError(f"{self.language} in {precision} cannot be run here: {reason}")
        values = self.evaluate(source, function, points, precision)
        expected = (points.shape[0], result_count(function))
        if values.shape != expected:
            raise ToolchainError(
                f"{self.language} code of {function.name} gave values of shape {values.shape}, "
                f"not {expected}"
            )
        return values


def result_count(function: Function) -> int:
    """Return the number of results of one evaluation."""
    return 1 if function.result is None else function.result


def compile_failure(language: str, function: Function, precision: str) -> str:
    """Return the first line of the error when a compiler refuses a function."""
    return f"{language} code of {function.name} in {precision} does not compile"


def run_failure(language: str, function: Function, precision: str) -> str:
    """Return the first line of the error when a compiled function does not run to its end."""
    return f"{language} code of {function.name} in {precision} compiles but does not run"
