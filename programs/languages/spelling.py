"""What a language is: everything that the printer needs to know to write its code."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from programs.functions import COMPONENT
from programs.precision import PRECISIONS


class Precedence(IntEnum):
    """The precedence of an expression: the higher, the fewer places need parentheses around it."""

    ARGUMENT = 0
    SELECTION = 1
    LOGIC = 2
    EQUALITY = 4
    COMPARISON = 5
    SUM = 6
    PRODUCT = 7
    SIGN = 8
    ATOM = 10


@dataclass(frozen=True)
class Spelling:
    """How an operation is written.

    `template` has {0}, {1}, … for the operands. `precedence` is that of the whole expression.
    `atoms` is True if an operand is written more than once, so that each operand must be a name or
    a literal.
    """

    template: str
    precedence: Precedence = Precedence.ATOM
    atoms: bool = False


@dataclass(frozen=True)
class Triple:
    """How a vector of three numbers is written.

    `kind` is its type; None: it is an array of three numbers. `component` is a template with
    {vector}, {letter} and {index} (`programs.functions.component_of`).
    """

    kind: str | None = None
    component: str = "{vector}[{index}]"

    def type_and_extent(self, real: str, count: int | None = None) -> tuple[str, str | None]:
        """Return the type of the elements and the size of an array that stands for vectors.

        `count` is the number of vectors, or None for one that is in no array. The size is None if
        no array is needed. In C an array of arrays has two sizes, of which a template knows one.
        """
        if self.kind is not None:
            return self.kind, None if count is None else str(count)
        return real, "3" if count is None else f"{count}][3"


def typed_triples(types: Mapping[str, str], component: str = COMPONENT) -> dict[str, Triple]:
    """Return the vectors of three numbers of each precision, from the names of their types."""
    return {precision: Triple(kind, component) for precision, kind in types.items()}


@dataclass(frozen=True)
class Language:
    """A language that functions are written in.

    The fields whose values contain braces are templates for `str.format`; the comments name what
    they may contain. The keys of the mappings by precision are the precisions of the language.
    """

    key: str
    name: str
    # of source files, without the dot
    extension: str
    # precision -> type of its numbers
    types: Mapping[str, str]
    # precision -> template of a literal, with {} for the digits
    literals: Mapping[str, str]
    # precision -> operation -> spelling; the operators that all languages share need none
    functions: Mapping[str, Mapping[str, Spelling]]
    # names that no function, argument or variable may have: words and macros
    reserved: frozenset[str]
    # names that no function, structure or namespace may have: functions and types that the language
    # or its library has, which an argument or a variable may hide
    library: frozenset[str]
    # precision -> lines at the start of a file
    prologue: Mapping[str, tuple[str, ...]]
    # start of a comment
    comment: str = "//"
    # type of a condition
    boolean: str = "bool"
    # arguments: {type}, {name} and, for arrays, {size}; an empty array_result means that the
    # results are returned, not stored in an array
    scalar_argument: str = "{type} {name}"
    array_argument: str = "{type} {name}[{size}]"
    array_result: str = "{type} {name}[{size}]"
    # heads of functions with a scalar and with an array result: {type}, {function}, {arguments}
    scalar_head: str = "{type} {function}({arguments})"
    array_head: str = "void {function}({arguments})"
    body_opening: str | None = "{"
    body_closing: str | None = "}"
    # {type}, {name}, {value}
    local_variable: str = "const {type} {name} = {value};"
    # {value}
    return_statement: str = "return {value};"
    # stores one of several results: {name}, {index}, {value}
    store_statement: str = "{name}[{index}] = {value};"
    # returns several results together: {values}; None: they are stored one by one
    return_all: str | None = None
    # three of the results that are returned together: {values}
    return_three: str = "{values}"
    # precision -> how max(min(x, {2}), {1}) is written: a template for any two ends, and
    # one for 0 and 1
    clamps: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    # precision -> type of a vector of four numbers
    vectors: Mapping[str, str] = field(default_factory=dict)
    # precision -> vector of three numbers; without, it is an array of three numbers
    triples: Mapping[str, Triple] = field(default_factory=dict)
    # around the members of a structure: {name}; None: the language has tuples or arrays instead
    record_opening: str | None = "struct {name} {{"
    record_closing: str = "}};"
    # members of a structure: {type}, {name} and, for arrays, {size}
    record_number: str = "{type} {name};"
    record_array: str = "{type} {name}[{size}];"
    # a structure without a value yet: {type}, {name}
    record_variable: str = "{type} {name};"
    # whether code can be in a namespace; whether there is a preprocessor for an include guard
    namespaces: bool = False
    preprocessor: bool = True
    # around the array of constants: {type}, {name}, {size}
    table_opening: str = "static const {type} {name}[{size}] = {{"
    table_closing: str = "}};"
    # statements at the start of a body that convert an argument to the precision: {type}, {name}
    scalar_conversion: str | None = None
    array_conversion: str | None = None
    vectors_conversion: str | None = None
    # a literal whose surroundings do not show its type: {type}, and {} for the literal
    typed_literal: str = "{}"
    # whether an expression of several lines must be in parentheses
    parenthesize_lines: bool = False
    # the longest program that can reasonably be printed
    max_operations: int = 20_000

    def triple(self, precision: str) -> Triple:
        """Return how a vector of three numbers is written in a precision."""
        return self.triples.get(precision, Triple())


def spell(functions: Mapping[str, str | Spelling]) -> dict[str, Spelling]:
    """Complete a table of spellings: a function's name becomes the template of its call.

    Arguments: `functions`, operation -> a `Spelling`, or the name of a function that takes the same
    operands. Returns operation -> `Spelling`.
    """
    calls = {1: "({0})", 2: "({0}, {1})"}
    spelled = {}
    for operation, how in functions.items():
        count = 2 if operation in _BINARY else 1
        spelled[operation] = Spelling(how + calls[count]) if isinstance(how, str) else how
    return spelled


_BINARY = {"min", "max", "pow", "atan2", "and", "or"}


def words(*lists: str) -> frozenset[str]:
    """Split strings of words at spaces and return all words."""
    return frozenset(word for each in lists for word in each.split())


def shortest_decimal(value: float, precision: str) -> str:
    """Write a number with the fewest digits that read back as the same number of that precision.

    Arguments: `value`, which is rounded to the precision first; `precision`, a key of PRECISIONS.
    Returns a decimal with a point, and with an exponent if it is very small or large. Raises
    ValueError when the rounded value is not finite.
    """
    dtype = PRECISIONS[precision]
    with np.errstate(over="ignore"):
        rounded = dtype(value)
    if not np.isfinite(rounded):
        largest = float(np.finfo(dtype).max)
        raise ValueError(f"constant {value!r} is no {precision}; allowed: at most {largest!r}")
    size = abs(float(rounded))
    if size == 0 or 1e-4 <= size < 1e7:
        return np.format_float_positional(rounded, unique=True, trim="0")
    return np.format_float_scientific(rounded, unique=True, trim="0", exp_digits=1)
