"""Functions to export: a JAX function of scalars, with argument names, domains and units."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal

Layout = Literal["array", "struct", "vec4"]
# What the numbers of a parameter are: an array, one vector of three, or an array of such vectors.
Shape = Literal["array", "vector", "vectors"]
_LETTERS = "xyz"


# How a component of a vector is written in most languages
COMPONENT = "{vector}.{letter}"


def component_of(template: str, vector: str, index: int) -> str:
    """Write component 0, 1 or 2 of a vector by a template with {vector}, {letter} and {index}."""
    return template.format(vector=vector, letter=_LETTERS[index], index=index)


@dataclass(frozen=True)
class Record:
    """A structure in exported code that holds the results of one function for another function.

    `name` is that of the type. `layout` says what it contains: one array `member[…]`; a number for
    each result, `member0`, `member1`, …; or vectors of four numbers, which have these names. The
    last is what constant buffers hold without padding. If `vectors` has names, the structure
    contains a vector of three numbers for each of them instead. Languages without types of
    variables have a tuple or an array instead. Raises ValueError for a name that is not an
    identifier.
    """

    name: str
    layout: Layout = "array"
    member: str = "m"
    vectors: tuple[str, ...] = ()

    def __post_init__(self):
        require_identifier("record", self.name)
        for member in (self.member, *self.vectors):
            require_identifier("member", member)

    def place(self, index: int, component: str = COMPONENT) -> str:
        """Return the member that holds result number `index`.

        `component` is how a component of a vector is written, as in `component_of`.
        """
        if self.vectors:
            return component_of(component, self.vectors[index // 3], index % 3)
        if self.layout == "array":
            return f"{self.member}[{index}]"
        if self.layout == "struct":
            return f"{self.member}{index}"
        return f"{self.member}{index // 4}.{'xyzw'[index % 4]}"


@dataclass(frozen=True)
class Parameter:
    """One argument of an exported function.

    `name` is the identifier that appears in the shader. `domain` is the closed interval (low, high)
    that the function is made for, in `unit`; for an array it holds for each element. `size` is None
    for a scalar and n for an array of n numbers. If the array is the content of a structure, that
    is `record`. `shape` says whether the n numbers are an array, one vector (n = 3) or an array of
    n/3 vectors of three. Raises ValueError for a name that is not an identifier, for an empty or
    infinite domain, for a size below one, and for one that vectors cannot have.
    """

    name: str
    domain: tuple[float, float]
    unit: str = "1"
    size: int | None = None
    record: Record | None = None
    shape: Shape = "array"

    def __post_init__(self):
        require_identifier("parameter", self.name)
        low, high = self.domain
        if not (isfinite(low) and isfinite(high) and low <= high):
            raise ValueError(
                f"domain of {self.name} is {self.domain!r}; "
                "allowed: (low, high), finite, low <= high"
            )
        _require_count(f"size of {self.name}", self.size)
        size = self.size or 0
        fits = {"array": True, "vector": size == 3, "vectors": size > 0 and size % 3 == 0}
        if not fits[self.shape]:
            raise ValueError(
                f"size of {self.name} is {self.size!r}; allowed: 3 for a vector, a multiple of 3 "
                "for vectors"
            )

    def places(self, component: str = COMPONENT) -> tuple[str, ...]:
        """Return how each number is written in code; `component` as in `component_of`."""
        if self.size is None:
            return (self.name,)
        if self.shape == "array":
            return tuple(f"{self.name}[{index}]" for index in range(self.size))
        vectors = [self.name]
        if self.shape == "vectors":
            vectors = [f"{self.name}[{index}]" for index in range(self.size // 3)]
        return tuple(component_of(component, each, k) for each in vectors for k in range(3))


@dataclass(frozen=True)
class Function:
    """A named JAX function that can be printed as code, counted, compiled and verified.

    `call` takes its arguments in the order of `parameters`: a scalar for each scalar parameter, a
    tuple of scalars for each array. If `result` is None, it returns one scalar. Otherwise it
    returns a tuple of `result` scalars, and printed code stores them in an array that is called
    `result_name`, or returns them in a structure `record`. `summary` is one line for the comment
    above the code. Raises ValueError for names that are not identifiers or that occur twice, and
    for a `result` below one.
    """

    name: str
    summary: str
    parameters: tuple[Parameter, ...]
    result: int | None
    result_name: str
    call: Callable[..., Any]
    record: Record | None = None

    def __post_init__(self):
        require_identifier("function", self.name)
        require_identifier("result", self.result_name)
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
    record: Record | None = None,
) -> Function:
    """Wrap any JAX function of scalars in a `Function`, with defaults for what is rarely needed.

    Arguments: `name` and `parameters`, as they appear in the shader; `call`, the JAX function;
    `summary`, one line for the comment above the code; `result`, None for a scalar result, else the
    number of results, which are stored in an array that is called `result_name`, or returned in a
    `record`. Returns the function. Raises ValueError for names that are not identifiers or that
    occur twice.
    """
    text = summary or f"{name}."
    return Function(name, text, tuple(parameters), result, result_name, call, record)


def input_names(function: Function) -> tuple[str, ...]:
    """Return a name for each number of one evaluation's input, in order.

    A scalar `x` has the name `x`; an array `c` of two has the names `c[0]` and `c[1]`.
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

    Arguments: `values`, one number (or one column of numbers) for each of `input_names`, in that
    order. Returns one entry for each parameter: the value of a scalar, a tuple of values of an
    array. Raises ValueError when `values` has another length than `input_names`.
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


def require_identifier(kind: str, name: str) -> None:
    """Raise ValueError, which says what `kind` of name it is, for a name that is no identifier."""
    if not (isinstance(name, str) and name.isascii() and name.isidentifier()):
        raise ValueError(
            f"{kind} name {name!r} is no identifier; allowed: letters, digits and '_', "
            "not beginning with a digit"
        )


def _require_count(what: str, count: int | None) -> None:
    if count is not None and count < 1:
        raise ValueError(f"{what} is {count!r}; allowed: None (a scalar) or a count of at least 1")
