"""Functions of the axes that a user gives for a shape, and how they are written in an equation."""

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp

from integrals.reference import Axis
from integrals.user_functions import label
from programs.functions import Function, Parameter
from programs.printing.formula import formulas
from programs.tracing.tracer import trace

# Tracing needs a range for every input, but the text does not depend on it.
_ANY = (-1.0, 1.0)
_NAMED = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)


@dataclass(frozen=True)
class Variables:
    """The variables of a shape: `at` maps a point of the axes to their values.

    `symbols` are how an equation calls them. `definitions` are the statements before the equation,
    such as 'z = η − 1'; there are none if the variables are the axes.
    """

    at: Callable[..., tuple[Any, ...]]
    symbols: tuple[str, ...]
    definitions: tuple[str, ...] = ()


def variables_of(of: Callable | None, axes: Sequence[Axis]) -> Variables:
    """Return the variables that `of` computes from the axes, or the axes if it is None.

    `of` takes axes by name, and returns a scalar or a tuple of scalars. Raises ValueError for a
    function of other arguments, or that returns something else.
    """
    if of is None:
        return Variables(lambda *point: point, tuple(axis.symbol for axis in axes))
    call = function_of_axes(of, axes)
    results = _results(of, call, axes)
    taken = {text for axis in axes for text in (axis.name, axis.symbol)}
    letter = next(each for each in "ztuwvs" if each not in taken)
    many = results is not None
    symbols = tuple(f"{letter}{k + 1}" for k in range(results)) if many else (letter,)
    texts = written(call, axes, results)
    return Variables(
        call if many else lambda *point: (call(*point),),
        symbols,
        tuple(f"{s} = {text}" for s, text in zip(symbols, texts, strict=True)),
    )


def function_of_axes(function: Callable, axes: Sequence[Axis]) -> Callable[..., Any]:
    """Return a function of a whole point that passes on the axes that `function` takes by name.

    An argument that is no axis may have a default, which is kept. Raises ValueError for any other
    argument that is no axis.
    """
    names = [axis.name for axis in axes]
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):
        parameters = None
    if parameters is None or any(_is_strange(each, names) for each in parameters):
        raise ValueError(f"{label(function)}: allowed arguments are the axes {', '.join(names)}")
    wanted = [each.name for each in parameters if each.name in names]

    def call(*point):
        given = dict(zip(names, point, strict=True))
        return function(**{name: given[name] for name in wanted})

    return call


def scalar_of_axes(function: Callable, axes: Sequence[Axis]) -> tuple[Callable[..., Any], str]:
    """Return `function_of_axes` of a function that has to return a scalar, and its text."""
    call = function_of_axes(function, axes)
    if _results(function, call, axes) is not None:
        raise ValueError(f"{label(function)} returns a tuple: expected is a scalar")
    (text,) = written(call, axes, None)
    return call, text


def written(call: Callable[..., Any], axes: Sequence[Axis], results: int | None) -> list[str]:
    """Write a function of the axes as text with their symbols, such as 'η − 1'.

    `results` is the length of the tuple that it returns; None if it returns a scalar. Raises
    ValueError for an operation that cannot be exported.
    """
    parameters = tuple(Parameter(axis.name, _ANY) for axis in axes)
    # The text is the same in either precision: quantities can be imported in both.
    with jax.ensure_compile_time_eval(), jax.enable_x64(True):
        program = trace(Function("of", "", parameters, results, "result", call))
    return formulas(program, [axis.symbol for axis in axes])


def _is_strange(parameter: inspect.Parameter, names: Sequence[str]) -> bool:
    if parameter.kind not in _NAMED:
        return True
    return parameter.name not in names and parameter.default is parameter.empty


def _results(function: Callable, call: Callable, axes: Sequence[Axis]) -> int | None:
    """Return the length of the tuple that a function returns; None if it returns a scalar."""
    number = jax.ShapeDtypeStruct((), jnp.result_type(float))
    shapes = jax.eval_shape(call, *[number for _ in axes])
    each = shapes if isinstance(shapes, tuple) else (shapes,)
    if not each or any(getattr(part, "shape", None) != () for part in each):
        raise ValueError(f"{label(function)} has to return a scalar or a tuple of scalars")
    return len(shapes) if isinstance(shapes, tuple) else None
