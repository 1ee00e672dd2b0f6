"""The variable names that the author of a JAX function chose, read from its source code.

Every equation of a jaxpr carries a traceback. It leads to the expression in the author's source
that the equation came from, and so to the name that the expression was assigned to.
"""

import ast
import linecache
from collections.abc import Callable
from functools import lru_cache
from itertools import islice
from pathlib import Path
from threading import Lock
from types import CodeType
from typing import Any

import jax

_JAX = str(Path(jax.__file__).parent)

# Python 3.11 counts the depth of recursion of all threads that parse together, and may fail.
_PARSING = Lock()

# The position of an expression: first line, last line, first column, last column.
Position = tuple[int | None, int | None, int | None, int | None]
# An expression in a source file: the file and the position.
Place = tuple[str, Position]


def places(source_info: Any, within: Callable[[CodeType], bool]) -> tuple[Place, ...]:
    """Find the expressions in the author's source that an equation of a jaxpr comes from.

    Arguments: `source_info` of the equation; `within`, which returns whether a code object is that
    of the traced function. Frames outside the traced function belong to its callers and are
    ignored. Returns the expressions that were being evaluated, innermost first, without those in
    JAX's own code. If the traced function is not in the traceback, only the innermost is returned.
    """
    if source_info.traceback is None:
        return ()
    codes, instructions = source_info.traceback.raw_frames()
    found: list[Place] = []
    for code, instruction in zip(codes, instructions, strict=True):
        if not is_jax(code.co_filename):
            # An instruction takes two bytes; co_positions has one entry for each instruction.
            positions = next(islice(code.co_positions(), instruction // 2, None))
            found.append((code.co_filename, positions))
        if within(code):
            return tuple(found)
    return tuple(found[:1])


def assigned_name(where: Place) -> str | None:
    """Return `name` if the expression at `where` is the right-hand side of `name = …`, or None."""
    file, position = where
    return _assignments(file).get(position)


def is_jax(file: str) -> bool:
    """Return whether a source file belongs to JAX; its variable names would not help a reader."""
    return file.startswith(_JAX)


@lru_cache(maxsize=64)
def _assignments(file: str) -> dict[Position, str]:
    # If the source is missing or has changed, only names are lost: the program stays the same.
    try:
        with _PARSING:
            tree = ast.parse("".join(linecache.getlines(file)))
    except SyntaxError:
        return {}
    names: dict[Position, str] = {}
    for node in ast.walk(tree):
        match node:
            case (
                ast.Assign(targets=[ast.Name(id=name)], value=value)
                | ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value)
                | ast.NamedExpr(target=ast.Name(id=name), value=value)
            ):
                for part in _alternatives(value):
                    span = (part.lineno, part.end_lineno, part.col_offset, part.end_col_offset)
                    names[span] = name
    return names


def _alternatives(value: ast.expr) -> list[ast.expr]:
    """Return an expression, and for `x if condition else y` also x and y."""
    if not isinstance(value, ast.IfExp):
        return [value]
    return [value, *_alternatives(value.body), *_alternatives(value.orelse)]
