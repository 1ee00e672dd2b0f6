"""The branch and bound search in compiled interval arithmetic, for proofs of largest errors.

The code of a program is printed in C (`interval_code.py`), put between the files of `kernel/`, and
compiled. While it runs, the processor rounds upward, so that all bounds are rounded outwards.
"""

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from programs.bounding.interval_code import FILES
from programs.toolchains.process import ToolchainError, execute, missing_command, workspace

COMPILER = "gcc"
# No operation is moved across the change of the rounding mode, folded, fused or made approximate.
_FLAGS = ("-std=gnu11", "-O2", "-shared", "-fPIC", "-frounding-math", "-ffp-contract=off")
_FAILURE = "the search in interval arithmetic does not compile"
_FASTER = ("-march=native", "-fno-math-errno")
# Seconds. A program of two thousand steps takes about a minute.
_COMPILE_LIMIT = 600.0

FINISHED, BUDGET, STACK_FULL, STUCK, ROUNDING, REFUTED = range(6)


def compiler_missing() -> str | None:
    """Return None if there is a compiler for the kernel, else the reason in one line."""
    return missing_command(COMPILER, COMPILER)


@dataclass(frozen=True)
class Kernel:
    """A compiled search for one error function of `sides` variables."""

    library: ctypes.CDLL
    sides: int

    def enclose(self, box: np.ndarray) -> tuple[float, float, float, float]:
        """Bound the error on a box (sides, 2), and at its centre: two lower and upper bounds."""
        ends = np.ascontiguousarray(np.asarray(box, float).T)
        bounds = np.empty(4)
        self.library.shadefit_enclose(_pointer(ends), _pointer(bounds))
        first, second, third, fourth = bounds.tolist()
        return first, second, third, fourth


def compile_kernel(
    parts: Sequence[str], sides: int, roots_are_defined: bool = False, fast: bool = False
) -> Kernel:
    """Compile a search.

    Arguments: `parts`, C code that ends with the function `error_at`; `sides`, the number of
    variables; `roots_are_defined`, whether it is proven that no radicand is negative, so that the
    part of its bounds below zero, which comes from rounding, may be left out; `fast`, whether to
    spend seconds on compiling a search that will be long. Raises ToolchainError if the compiler is
    missing or fails.
    """
    reason = compiler_missing()
    if reason is not None:
        raise ToolchainError(reason)
    options = {"INLINE_ALL": fast, "ROOTS_ARE_DEFINED": roots_are_defined}
    head = f"#define NVAR {sides}\n" + "".join(f"#define {k}\n" for k, on in options.items() if on)
    code = [head, *(file.read_text("utf-8") for file in FILES), *parts]
    code.append((FILES[0].parent / "search.h").read_text("utf-8"))
    with workspace() as folder:
        (folder / "kernel.c").write_text("\n".join(code), encoding="utf-8")
        for extra in (_FASTER, ()):
            command = [COMPILER, *_FLAGS, *extra, "kernel.c", "-o", "kernel.so", "-lm"]
            try:
                execute(command, failure=_FAILURE, folder=folder, seconds=_COMPILE_LIMIT)
                break
            except ToolchainError:
                # Some compilers do not know the processor that they run on.
                if not extra:
                    raise
        library = ctypes.CDLL(str(folder / "kernel.so"))
    library.shadefit_search.restype = None
    library.shadefit_enclose.restype = None
    return Kernel(library, sides)


def _pointer(array: np.ndarray):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def search_structure(sides: int) -> type[ctypes.Structure]:
    """Return the type of the kernel's `search` structure."""
    number, count = ctypes.c_double, ctypes.c_long

    class Search(ctypes.Structure):
        _fields_ = (
            ("stack", ctypes.POINTER(number)),
            ("depth", count),
            ("capacity", count),
            ("budget", count),
            ("ratio", number),
            ("level", number),
            ("lower", number),
            ("at", number * sides),
            ("whole", number * sides),
            ("reached", number),
            ("volume", number),
            ("boxes", count),
            ("status", count),
            ("leaves", ctypes.POINTER(number)),
            ("leaf_count", count),
            ("leaf_capacity", count),
        )

    return Search
