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
from programs.operations import OPERATIONS
from programs.program import interpret
from programs.tracing.tracer import trace

# Tracing needs a range for every input, but the text does not depend on it.
_ANY = (-1.0, 1.0)
_NAMED = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)


@dataclass(frozen=True)
class Variables:
    """The variables of a shape: `at` maps a point of the axes to their values.

    `symbols` are how an equation calls them. `definition` is the text that follows the equation,
    such as ', z = η − 1'; it is empty if the variables are the axes.
    """

    at: Callable[..., tuple[Any, ...]]
    symbols: tuple[str, ...]
    definition: str = ""


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
    definition = "".join(f", {s} = {text}" for s, text in zip(symbols, texts, strict=True))
    return Variables(
        call if many else lambda *point: (call(*point),),
        symbols,
        definition,
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
    with jax.ensure_compile_time_eval():
        program = trace(Function("of", "", parameters, results, "result", call))
    symbols = [(axis.symbol, _ATOM) for axis in axes]
    return [text for text, _ in interpret(program, symbols, _WRITERS, _number)]


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


# How tightly a text holds together: a sum, a product, a sign, or a name.
_SUM, _PRODUCT, _SIGN, _ATOM = range(4)
_Text = tuple[str, int]


def _inside(part: _Text, least: int) -> str:
    text, holds = part
    return text if holds >= least else f"({text})"


def _to_the_right(part: _Text, least: int) -> str:
    return f"({part[0]})" if part[0].startswith("−") else _inside(part, least)


def _infix(sign: str, holds: int, right: int) -> Callable[[_Text, _Text], _Text]:
    return lambda a, b: (f"{_inside(a, holds)}{sign}{_to_the_right(b, right)}", holds)


def _product(a: _Text, b: _Text) -> _Text:
    if a == b and a[1] == _ATOM and not a[0].endswith("²"):
        return f"{a[0]}²", _ATOM
    return _infix("·", _PRODUCT, _PRODUCT)(a, b)


def _called(name: str) -> Callable[..., _Text]:
    return lambda *parts: (f"{name}({', '.join(text for text, _ in parts)})", _ATOM)


_WRITERS: dict[str, Callable[..., _Text]] = {
    **{name: _called(name) for name in OPERATIONS},
    "add": _infix(" + ", _SUM, _SUM),
    "sub": _infix(" − ", _SUM, _PRODUCT),
    "mul": _product,
    "div": _infix("/", _PRODUCT, _SIGN),
    "neg": lambda a: (f"−{_inside(a, _SIGN)}", _SIGN),
}


def _number(value: float) -> _Text:
    text = repr(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(value)
    return (f"−{text[1:]}", _SIGN) if text.startswith("-") else (text, _ATOM)
