"""Kernels for tests: many expressions in one compiled search, and one expression alone."""

import re
from collections.abc import Callable, Iterable, Mapping

import numpy as np

from programs.bounding.compiled import Kernel, compile_kernel
from programs.bounding.interval_code import INTERVAL_C
from programs.bounding.rounding import rounding_parts
from programs.bounding.rounding_model import RoundingModel
from programs.functions import Function, Parameter
from programs.printing.printer import write_source
from programs.program import Program

NAMES = "xyz"


def code_of(name: str, call: Callable, sides: int) -> str:
    parameters = tuple(Parameter(each, (-1.0, 1.0)) for each in NAMES[:sides])
    return write_source(Function(name, "", parameters, None, "value", call), INTERVAL_C, "double")


def kernel_of(call: Callable, sides: int = 1, **options) -> Kernel:
    arguments = ", ".join(f"x[{k}]" for k in range(sides))
    entry = f"static jet error_at(boxes *K, const jet *x) {{ return expression(K, {arguments}); }}"
    return compile_kernel([code_of("expression", call, sides), entry], sides, **options)


class Kernels:
    """A kernel with several expressions, one of which is chosen at a time: one compilation.

    `code` has their functions. `call` is the call of one, in which {k} is its number.
    """

    def __init__(self, names: Iterable[str], code: list[str], call: str, sides: int):
        self.places = {name: k for k, name in enumerate(names)}
        cases = " ".join(f"case {k}: return {call.format(k=k)};" for k in self.places.values())
        chosen = (
            f"static int place; void choose_place(int k) {{ place = k; }}\n"
            f"static jet error_at(boxes *K, const jet *x) {{ switch (place) {{ {cases} }} "
            "K->bad = ~(M){0}; return x[0]; }"
        )
        self.kernel = compile_kernel([*code, chosen], sides)

    def __call__(self, name: str, lower, upper) -> tuple[float, float, float, float]:
        """Bound an expression on a box, and its value at the centre."""
        self.kernel.library.choose_place(self.places[name])
        return self.kernel.enclose(np.stack([np.atleast_1d(lower), np.atleast_1d(upper)], axis=1))


def kernels_of(calls: Mapping[str, Callable], sides: int) -> Kernels:
    code = [code_of(f"expression_{k}", call, sides) for k, call in enumerate(calls.values())]
    arguments = ", ".join(f"x[{k}]" for k in range(sides))
    return Kernels(calls, code, f"expression_{{k}}(K, {arguments})", sides)


def rounding_kernels_of(
    programs: Mapping[str, Program], model: RoundingModel, sides: int
) -> Kernels:
    """Return the bounds of the rounding errors of several programs."""
    given = " ".join(f"v[{k}] = x[{k}];" for k in range(sides))
    code: list[str] = []
    for k, program in enumerate(programs.values()):
        first, *parts = rounding_parts(program, model, given, [False] * sides)
        code += [] if code else [first]
        code += [re.sub(r"\b(error_of|value_of|error_at)\b", rf"\1_{k}", part) for part in parts]
    return Kernels(programs, code, "error_at_{k}(K, x)", sides)
