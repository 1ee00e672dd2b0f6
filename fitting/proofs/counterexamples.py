"""Points where a form's error is above a level, found by the search that proves largest errors."""

from collections.abc import Callable

import numpy as np

from fitting.form import FittedForm
from fitting.proofs.largest_error import ErrorCode
from fitting.solvers.elsewhere import Counterexamples
from integrals.reference import box_of
from programs.bounding.compiled import compiler_missing
from programs.bounding.counterexamples import points_above
from programs.toolchains.process import ToolchainError

# The most boxes of one search, about a minute of P_s on one core
MAX_BOXES = 50_000_000


def counterexamples(
    code_of_error: Callable[[FittedForm], ErrorCode | None], max_boxes: int = MAX_BOXES
) -> Counterexamples | None:
    """Return a search for points with errors above a level; None without a compiler.

    `code_of_error` returns the code of a form's error, or None if a form has none: then no point is
    found. A search gives up after `max_boxes` boxes.
    """
    if compiler_missing() is not None:
        return None

    def search(fitted: FittedForm, level: float) -> np.ndarray:
        none = np.empty((0, len(fitted.axes)))
        try:
            code = code_of_error(fitted)
            if code is None:
                return none
            kernel = code.kernel()
        except (ValueError, ToolchainError):
            # The closed form has operations that are not known, or the code does not compile.
            return none
        found = points_above(kernel, code.box, level + code.inexact, max_boxes=max_boxes)
        return np.clip(code.to_axes(found), *box_of(fitted.axes).T) if len(found) else none

    return search
