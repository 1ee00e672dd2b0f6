"""A proven bound of what float32 rounding adds to a form's error, in code that is exported."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from fitting.proofs.largest_error import printed
from integrals.reference import Axis, box_of
from programs.bounding.compiled import Kernel, compile_kernel, compiler_missing
from programs.bounding.largest import LargestValue, Report, bound_largest
from programs.bounding.rounding import chained, rounding_parts
from programs.bounding.rounding_model import RoundingModel
from programs.functions import Function
from programs.printing.lowering import lowered
from programs.toolchains.process import ToolchainError
from programs.tracing.tracer import trace

# The bound and the largest value found of the sum that it bounds are at most this far apart, for
# one or two variables and for more.
RATIO, RATIO_OF_MANY = 1.2, 1.25
# The search gives up after so many boxes: some minutes on one core.
MAX_BOXES = 5_000_000
# The search begins with the largest of so many values, and those of the corners.
_SEEDS = 2000
# Longer code takes minutes to compile.
_MOST_STEPS = 300


@dataclass(frozen=True)
class TracedArguments:
    """The arguments of exported functions as a JAX function, of variables that a proof divides.

    * `axes`: the variables and their domains.
    * `call`: maps a value of each variable to the own arguments of all functions, in order.
    * `rounded`: for each argument, whether it is computed from the variables, and then rounded to
      float32. The others are variables themselves.
    """

    axes: tuple[Axis, ...]
    call: Callable[..., tuple]
    rounded: tuple[bool, ...]


def bound_rounding(
    functions: Sequence[Function],
    arguments: TracedArguments,
    model: RoundingModel,
    ratio: float | None = None,
    *,
    threads: int = 2,
    max_boxes: int = MAX_BOXES,
    progress: Report = lambda _: None,
) -> LargestValue:
    """Bound the difference between the float32 value of exported functions and their exact value.

    Both are for the same arguments, which are float32 numbers and not below the smallest normal
    one, unless they are zero. The exact value is that of the operations without rounding, with
    constants in float64. Arguments: `functions`, in the order of the calls; `model`, the errors of
    single operations; `ratio`, above 1, of the bound to the largest sum of errors that was found;
    `threads`; `max_boxes`, after which the search gives up; `progress`, which is called several
    times a second. Returns the bound as `upper`, which is None if there is no proof. Raises
    ValueError without a C compiler, for an infinite domain, and for an operation without a model.
    """
    box = rounded_box(arguments)
    kernel = rounding_kernel(functions, arguments, model)
    if ratio is None:
        ratio = RATIO if len(box) <= 2 else RATIO_OF_MANY
    rng = np.random.default_rng(0)
    seeds = np.concatenate([list(product(*box)), rng.uniform(*box.T, (_SEEDS, len(box)))])
    return bound_largest(
        kernel, box, ratio, seeds=seeds, threads=threads, max_boxes=max_boxes, progress=progress
    )


def rounding_kernel(
    functions: Sequence[Function], arguments: TracedArguments, model: RoundingModel
) -> Kernel:
    """Compile the bound of the rounding error as a function of the variables of `arguments`.

    On a box it bounds the error for all arguments in the box. Raises ValueError as `bound_rounding`
    does.
    """
    program = chained([trace(each) for each in functions])
    sides = len(arguments.axes)
    if not np.isfinite(box_of(arguments.axes)).all():
        raise ValueError(f"{program.name}: a domain is infinite; allowed are finite ones")
    count, names = len(arguments.rounded), tuple(f"x{k}" for k in range(sides))
    if count != len(program.inputs):
        raise ValueError(f"{program.name} has {len(program.inputs)} arguments; given: {count}")
    reason = compiler_missing()
    if reason is not None:
        raise ValueError(f"the proof needs a C compiler: {reason}")
    given = ", ".join(f"x[{k}]" for k in range(sides))
    parts = (
        printed("arguments", names, arguments.call, count),
        *rounding_parts(program, model, f"arguments(K, {given}, v);", arguments.rounded),
    )
    try:
        return compile_kernel(parts, sides)
    except ToolchainError as error:
        raise ValueError(f"{error.summary}: allowed is gcc or a compiler like it") from error


def can_be_bounded(functions: Sequence[Function], model: RoundingModel) -> bool:
    """Return whether a model has the error of each operation, and the search compiles soon.

    An operation that some languages write by others has no bound that holds for all of them.
    """
    programs = [trace(each) for each in functions]
    steps = [step for each in programs for step in each.steps]
    differ = any(lowered(each, ()) != each for each in programs)
    known = all(step.operation in model.errors for step in steps)
    return known and not differ and len(steps) <= _MOST_STEPS


def rounded_box(arguments: TracedArguments) -> np.ndarray:
    """Return the ends (sides, 2) of the domain, and of the domain with its ends in float32."""
    ends = box_of(arguments.axes)
    rounded = ends.astype(np.float32).astype(float)
    return np.stack(
        [np.minimum(ends[:, 0], rounded[:, 0]), np.maximum(ends[:, 1], rounded[:, 1])], axis=1
    )
