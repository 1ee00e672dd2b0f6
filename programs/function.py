"""What is exported: a scalar JAX function with the names, domains and units its users see."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any


@dataclass(frozen=True)
class Parameter:
    """One argument of an exported function.

    `name` is the identifier that the user of the shader sees, `domain` the closed interval that
    the function is made for (of each element, in `unit`), `size` is None for a scalar and n for a
    fixed array of n numbers. Raises ValueError for a name that is no identifier, an empty or
    infinite domain, or a size below one.
    """

    name: str
    domain: tuple[float, float]
    unit: str = "1"
    size: int | None = None

    def __post_init__(self):
        _require_identifier("parameter", self.name)
        low, high = self.domain
        if not (isfinite(low) and isfinite(high) and low <= high):
            raise ValueError(
                f"domain of {self.name} is {self.domain!r}; "
                "allowed: (low, high), finite, low <= high"
            )
        _require_count(f"size of {self.name}", self.size)


@dataclass(frozen=True)
class Function:
    """A named JAX function of scalars, as it is printed, counted, compiled and compared.

    `call` takes scalars, and tuples of scalars for arrays, in the order of `parameters`; it gives a
    scalar (`result` None) or a tuple of `result` scalars, which printed code fills into an array
    called `result_name`. `summary` is one line for the header. Raises ValueError for names that
    are no identifiers or that occur twice, and for a result below one.
    """

    name: str
    summary: str
    parameters: tuple[Parameter, ...]
    result: int | None
    result_name: str
    call: Callable[..., Any]

    def __post_init__(self):
        _require_identifier("function", self.name)
        _require_identifier("result", self.result_name)
        _require_count(f"result of {self.name}", self.result)
        names = [parameter.name for parameter in self.parameters]
        if self.result is not None:
            names.append(self.result_name)
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"name {name!r} occurs twice in {self.name}; allowed: once")


def function(
    name: str,
    parameters: Sequence[Parameter],
    call: Callable[..., Any],
    summary: str = "",
    result: int | None = None,
    result_name: str = "result",
) -> Function:
    """Make any JAX function of scalars one that can be exported, counted and verified.

    Arguments: `name` and `parameters` as the user of the shader sees them; `call`, in JAX;
    `summary`, one line for the comment above it; `result`, None for a scalar or how many numbers
    it gives, in an array called `result_name`. Returns the function. Raises ValueError for names
    that are no identifiers or occur twice.
    """
    return Function(name, summary or f"{name}.", tuple(parameters), result, result_name, call)


def input_names(function: Function) -> tuple[str, ...]:
    """Name every scalar input in order: `x` for a scalar, `c[0]`, `c[1]`, … for an array.

    Arguments: `function`. Returns as many names as there are numbers in one evaluation's input.
    """
    names = []
    for parameter in function.parameters:
        if parameter.size is None:
            names.append(parameter.name)
        else:
            names.extend(f"{parameter.name}[{index}]" for index in range(parameter.size))
    return tuple(names)


def group_inputs(function: Function, values: Sequence[Any]) -> tuple[Any, ...]:
    """Group a flat row of inputs into the arguments of `function.call`.

    Arguments: `function`; `values`, one number (or array) a scalar input, in the order of
    `input_names`. Returns one entry a parameter: the value, or a tuple of values for an array.
    Raises ValueError when their number differs from the function's.
    """
    expected = len(input_names(function))
    if len(values) != expected:
        raise ValueError(f"{function.name} was given {len(values)} inputs; allowed: {expected}")
    arguments, position = [], 0
    for parameter in function.parameters:
        count = 1 if parameter.size is None else parameter.size
        part = values[position : position + count]
        arguments.append(part[0] if parameter.size is None else tuple(part))
        position += count
    return tuple(arguments)


def _require_identifier(kind: str, name: str) -> None:
    if not (isinstance(name, str) and name.isascii() and name.isidentifier()):
        raise ValueError(
            f"{kind} name {name!r} is no identifier; allowed: letters, digits and '_', "
            "not beginning with a digit"
        )


def _require_count(what: str, count: int | None) -> None:
    if count is not None and count < 1:
        raise ValueError(f"{what} is {count!r}; allowed: None (a scalar) or a count of at least 1")
