"""How a language is spelled: everything that the printer needs to know of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

# The formats a function can be written in, with the type that rounds as they do.
PRECISIONS: dict[str, type[np.floating]] = {
    "half": np.float16,
    "float": np.float32,
    "double": np.float64,
}


class Precedence(IntEnum):
    """How tightly an expression holds together, from a whole argument to a single word."""

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
    """How an operation is written: a template of its operands, and how tightly it binds.

    `atoms` is set where an operand is written more than once, and so must be a name or a literal.
    """

    template: str
    precedence: Precedence = Precedence.ATOM
    atoms: bool = False


@dataclass(frozen=True)
class Language:
    """A language that functions are written in.

    Templates are `str.format` strings: `head_one` and `head_many` have {type}, {function} and
    {arguments}; the arguments {type}, {name}, {size}; `local` {type}, {name}, {value}; `store`
    {name}, {index}, {value}; `several` {values}; the table {type}, {name}, {size}. The mappings by
    precision say which precisions the language has.
    """

    key: str
    name: str
    extension: str
    types: Mapping[str, str]
    literals: Mapping[str, str]
    # operation -> spelling; an operation that is neither here nor an infix one cannot be written
    functions: Mapping[str, Mapping[str, Spelling]]
    reserved: frozenset[str]
    prologue: Mapping[str, tuple[str, ...]]
    comment: str = "//"
    boolean: str = "bool"
    scalar_argument: str = "{type} {name}"
    array_argument: str = "{type} {name}[{size}]"
    array_result: str = "{type} {name}[{size}]"
    scalar_head: str = "{type} {function}({arguments})"
    array_head: str = "void {function}({arguments})"
    body_opening: str | None = "{"
    body_closing: str | None = "}"
    local_variable: str = "const {type} {name} = {value};"
    return_statement: str = "return {value};"
    store_statement: str = "{name}[{index}] = {value};"
    # set where several results are returned together instead of stored one by one
    return_all: str | None = None
    table_opening: str = "static const {type} {name}[{size}] = {{"
    table_closing: str = "}};"
    # lines at the head of a body that bring an argument to the precision
    scalar_conversion: str | None = None
    array_conversion: str | None = None
    # a literal where nothing around it says its type
    typed_literal: str = "{}"
    # whether an expression that runs over lines must stand in parentheses
    parenthesize_lines: bool = False
    # the longest program that is worth printing
    max_operations: int = 20_000


def spell(functions: Mapping[str, str | Spelling]) -> dict[str, Spelling]:
    """Complete a table of spellings: a plain word becomes a call of that name.

    Arguments: `functions`, operation -> name of a function of the same operands, or a Spelling.
    Returns operation -> Spelling.
    """
    calls = {1: "({0})", 2: "({0}, {1})"}
    spelled = {}
    for operation, how in functions.items():
        count = 2 if operation in _BINARY else 1
        spelled[operation] = Spelling(how + calls[count]) if isinstance(how, str) else how
    return spelled


_BINARY = {"min", "max", "pow", "atan2", "and", "or"}


def words(*lists: str) -> frozenset[str]:
    """Split lists of words, as the reserved words of a language are best read and written."""
    return frozenset(word for each in lists for word in each.split())


def shortest_decimal(value: float, precision: str) -> str:
    """Write a number with the fewest digits that read back as the same number of that precision.

    Arguments: `value`, any finite number; `precision`, a key of PRECISIONS. Returns a decimal with
    a point, and an exponent where it is shorter. Raises ValueError when the rounded value is not
    finite.
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
