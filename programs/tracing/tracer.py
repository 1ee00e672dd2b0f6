"""Tracing a JAX function: its jaxpr is inlined, unrolled and written as a straight-line program."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from types import CodeType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.extend.core import ClosedJaxpr, Jaxpr, JaxprEqn, Literal

from programs.functions import Function, group_inputs, input_names
from programs.program import Program
from programs.tracing.authorship import Place, assigned_name, is_jax, places
from programs.tracing.builder import Builder
from programs.tracing.primitives import (
    CALLS,
    apply_primitive,
    evaluate_primitive,
    writable_primitives,
)

# More steps than any language allows. The limit stops the unrolling of very long loops.
LIMIT = 50_000


def trace(function: Function, limit: int = LIMIT, keep_undefined: bool = False) -> Program:
    """Trace a function into a straight-line program.

    Calls (jit, custom derivatives, checkpoints) are inlined, scans of fixed length are unrolled,
    and small arrays are split into scalars. Constants are folded in float64, and equal
    subexpressions are shared.

    Arguments: `function`, whose `call` is a JAX function of scalars; `limit`, the largest number of
    steps; `keep_undefined`, for proofs, keeps the steps that may be undefined although their result
    would not matter, such as x·0, and 1/0. Returns the program, whose inputs have the names of
    `input_names(function)`. Raises ValueError when float64 is off, when the results do not agree
    with `function.result`, when an operation cannot be written as shader code, and when there are
    more than `limit` steps.
    """
    if jnp.result_type(float) != np.float64:
        raise ValueError("jax_enable_x64 is False; allowed: True, set before a function is traced")
    names = input_names(function)
    scalar = jax.ShapeDtypeStruct((), np.float64)

    def flat(*values):
        return function.call(*group_inputs(function, values))

    def is_flat(code: CodeType) -> bool:
        return code is flat.__code__

    closed, shapes = jax.make_jaxpr(flat, return_shape=True)(*[scalar] * len(names))
    _require_results(function, shapes)
    builder = Builder(names, limit, keep_undefined)
    inputs = [np.array(number, dtype=object) for number in range(len(names))]
    outputs = _inline(function.name, builder, closed, inputs, is_flat)
    return builder.finish(function.name, [_scalar(output) for output in outputs])


def _inline(
    name: str,
    builder: Builder,
    closed: ClosedJaxpr,
    inputs: Sequence[Any],
    within: Callable[[CodeType], bool] | None,
) -> list[Any]:
    """Run a jaxpr on arrays: numeric arrays are constants, arrays of dtype object hold operands.

    `within` is as in `authorship.places`, or None where variable names are of no use.
    """
    jaxpr: Jaxpr = closed.jaxpr
    values: dict[Any, Any] = dict(zip(jaxpr.constvars, map(np.asarray, closed.consts), strict=True))
    values.update(zip(jaxpr.invars, inputs, strict=True))
    hints = _hints(jaxpr.eqns, within)
    for equation, assigned in zip(jaxpr.eqns, hints, strict=True):
        operands = [
            np.asarray(v.val) if isinstance(v, Literal) else values[v] for v in equation.invars
        ]
        results = _run(name, builder, equation, operands)
        # jax.ad_checkpoint.checkpoint_name names a value where no assignment does.
        hint = equation.params["name"] if equation.primitive.name == "name" else assigned
        if hint is not None and len(results) == 1:
            _name_all(builder, results[0], hint)
        values.update(zip(equation.outvars, results, strict=True))
    return [np.asarray(v.val) if isinstance(v, Literal) else values[v] for v in jaxpr.outvars]


def _run(name: str, builder: Builder, equation: JaxprEqn, operands: list[Any]) -> list[Any]:
    primitive = equation.primitive.name
    if primitive in CALLS:
        inner = equation.params[CALLS[primitive]]
        closed = inner if isinstance(inner, ClosedJaxpr) else ClosedJaxpr(inner, ())
        # Also for a function with a custom derivative, debug_info names the function's own source.
        return _inline(name, builder, closed, operands, _authored(closed))
    if primitive == "scan":
        return _unroll(name, builder, equation, operands)
    if all(operand.dtype != object for operand in operands):
        folded = evaluate_primitive(equation, operands)
        if not builder.keep_undefined or all(map(_is_defined, folded)):
            return folded
    try:
        return apply_primitive(builder, equation, operands)
    except KeyError:
        allowed = writable_primitives()
        raise ValueError(
            f"{primitive!r} in {name} cannot be written as shader code; allowed: {allowed}"
        ) from None
    except ValueError as error:
        raise ValueError(f"{primitive!r} in {name}: {error}") from error


def _is_defined(result: np.ndarray) -> bool:
    return not np.issubdtype(result.dtype, np.floating) or bool(np.all(np.isfinite(result)))


def _unroll(name: str, builder: Builder, equation: JaxprEqn, operands: list[Any]) -> list[Any]:
    params = equation.params
    fixed, carried = params["num_consts"], params["num_consts"] + params["num_carry"]
    constants, carry, series = operands[:fixed], operands[fixed:carried], operands[carried:]
    gathered: list[list[Any]] = []
    order = range(params["length"])
    for index in reversed(order) if params["reverse"] else order:
        arguments = [*constants, *carry, *(np.asarray(each[index]) for each in series)]
        results = _inline(name, builder, params["jaxpr"], arguments, None)
        carry, row = results[: params["num_carry"]], results[params["num_carry"] :]
        gathered.append(row)
    if params["reverse"]:
        gathered.reverse()
    return [*carry, *(np.stack(column) for column in zip(*gathered, strict=True))]


def _authored(closed: ClosedJaxpr) -> Callable[[CodeType], bool] | None:
    # JAX caches its own jitted functions, so their tracebacks lead to whoever called them first.
    info = closed.jaxpr.debug_info
    file, line = getattr(info, "func_filename", None), getattr(info, "func_lineno", None)
    if file is None or is_jax(file):
        return None
    return lambda code: (code.co_filename, code.co_firstlineno) == (file, line)


def _hints(
    equations: Sequence[JaxprEqn], within: Callable[[CodeType], bool] | None
) -> list[str | None]:
    if within is None:
        return [None] * len(equations)
    stacks = [places(equation.source_info, within) for equation in equations]
    return [_hint(here, following) for here, following in pairwise([*stacks, ()])]


def _hint(here: tuple[Place, ...], following: tuple[Place, ...]) -> str | None:
    # Several equations in a row may come from one expression, such as x = f(…). Only the last one
    # computes its value, so only that one gets the name. Of nested expressions, the innermost name
    # describes the equation best.
    for level in range(len(here)):
        outwards = len(here) - level
        if here[level:] == following[len(following) - outwards :]:
            return None
        name = assigned_name(here[level])
        if name is not None:
            return name
    return None


def _name_all(builder: Builder, value: Any, hint: str) -> None:
    if value.dtype != object:
        return
    for index, operand in enumerate(value.reshape(-1)):
        builder.name(operand, hint if value.ndim == 0 else f"{hint}{index}")


def _scalar(value: Any) -> Any:
    item = value.item()
    return item if value.dtype == object else float(item)


def _require_results(function: Function, shapes: Any) -> None:
    scalars = list(shapes) if isinstance(shapes, tuple | list) else [shapes]
    single = function.result is None and not isinstance(shapes, tuple | list)
    several = function.result == len(scalars) and isinstance(shapes, tuple | list)
    if not (single or several):
        expected = "a scalar" if function.result is None else f"a tuple of {function.result}"
        raise ValueError(f"{function.name} gives {shapes!r}; allowed: {expected}")
    for scalar in scalars:
        if scalar.shape != () or scalar.dtype != np.float64:
            raise ValueError(
                f"{function.name} gives a result of shape {scalar.shape} and type {scalar.dtype}; "
                "allowed: float64 scalars"
            )
