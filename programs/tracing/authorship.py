"""What the author of a JAX function called its intermediate values, read from its source."""

import ast
import linecache
from collections.abc import Callable
from functools import lru_cache
from itertools import islice
from pathlib import Path
from types import CodeType
from typing import Any

import jax

_JAX = str(Path(jax.__file__).parent)

# Where an expression stands: first line, last line, first column, last column.
Position = tuple[int | None, int | None, int | None, int | None]


# An expression in a source file.
Place = tuple[str, Position]


def places(source_info: Any, within: Callable[[CodeType], bool]) -> tuple[Place, ...]:
    """Find the expressions in the author's source that an equation of a jaxpr comes from.

    Arguments: `source_info` of the equation; `within`, which tells the code of the outermost call
    that is looked at: beyond it stand whoever called the function. Returns the expressions that
    were being evaluated outside of JAX, the innermost first; without an outermost call, that one.
    """
    if source_info.traceback is None:
        return ()
    codes, instructions = source_info.traceback.raw_frames()
    found: list[Place] = []
    for code, instruction in zip(codes, instructions, strict=True):
        if not is_jax(code.co_filename):
            # An instruction takes two bytes; co_positions gives one entry an instruction.
            positions = next(islice(code.co_positions(), instruction // 2, None))
            found.append((code.co_filename, positions))
        if within(code):
            return tuple(found)
    return tuple(found[:1])


def assigned_name(where: Place) -> str | None:
    """Give `name` when the expression at `where` is the right-hand side of `name = …`."""
    file, position = where
    return _assignments(file).get(position)


def is_jax(file: str) -> bool:
    """Tell whether a source file is JAX's own: its names mean nothing to a shader's reader."""
    return file.startswith(_JAX)


@lru_cache(maxsize=64)
def _assignments(file: str) -> dict[Position, str]:
    # Without its source (or with a stale one) a function loses its names, not its meaning.
    try:
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
                span = (value.lineno, value.end_lineno, value.col_offset, value.end_col_offset)
                names[span] = name
    return names
