"""Small changes of a module, one at a time, for `mutants.py`.

Code in Python is changed in its syntax tree, and code in C by patterns outside of comments.
"""

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
CONFIGURATION = tomllib.loads((Path(__file__).parent / "mutants.toml").read_text(encoding="utf-8"))

_COMPARISONS = {
    ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.Lt), ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,),
}  # fmt: skip
_OPERATORS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.And: ast.Or, ast.Or: ast.And,
    ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult,
}  # fmt: skip
_OTHER = {a: b for pair in CONFIGURATION["pairs"] for a, b in (pair, pair[::-1])}


class Mutant(NamedTuple):
    """A changed module: its path, the number and text of the line, the change, the new text."""

    module: str
    number: int
    line: str
    change: str
    source: str


def changes(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield a line and what is changed there, while the tree is changed."""
    # Types and messages are read by people. They, `frozen`, and `strict` of zip, compute nothing.
    idle: list[ast.AST | None] = []
    for node in ast.walk(tree):
        idle += [getattr(node, name, None) for name in ("annotation", "returns")]
        idle += [node] if isinstance(node, ast.JoinedStr) else []
        is_zip = isinstance(node, ast.Call) and ast.unparse(node.func) == "zip"
        idle += [each for each in getattr(node, "keywords", ()) if is_zip or each.arg == "frozen"]
    skipped = {id(part) for each in idle if isinstance(each, ast.AST) for part in ast.walk(each)}
    for node in (each for each in ast.walk(tree) if id(each) not in skipped):
        for place, key, new, what in (*_of_node(node), *_of_parts(node)):
            old = place[key] if isinstance(place, list) else getattr(place, key)
            put = place.__setitem__ if isinstance(place, list) else place.__setattr__
            put(key, new)
            yield getattr(old, "lineno", 0) or getattr(node, "lineno", 0), what
            put(key, old)


def _of_node(node: ast.AST) -> Iterator[tuple]:
    """Yield what may be changed in a node: an object or list, a key, the new value, and a text."""
    if isinstance(node, ast.Compare):
        for k, old in enumerate(node.ops):
            for new in _COMPARISONS[type(old)]:
                yield node.ops, k, new(), f"{type(old).__name__} -> {new.__name__}"
    elif isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign) and type(node.op) in _OPERATORS:
        new = _OPERATORS[type(node.op)]
        yield node, "op", new(), f"{type(node.op).__name__} -> {new.__name__}"
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float, bool):
        old = node.value
        others = [not old] if old is True or old is False else [old + 1, old - 1]
        for new in others if type(old) is not float else [old * 2, old / 2 if old else 1e-3]:
            yield node, "value", new, f"{old} -> {new}"
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        yield node, "test", ast.UnaryOp(ast.Not(), node.test), "condition negated"
    elif isinstance(node, ast.Name) and node.id in _OTHER and isinstance(node.ctx, ast.Load):
        yield node, "id", _OTHER[node.id], f"{node.id} -> {_OTHER[node.id]}"
    elif isinstance(node, ast.Attribute) and node.attr in _OTHER:
        yield node, "attr", _OTHER[node.attr], f".{node.attr} -> .{_OTHER[node.attr]}"


def _of_parts(node: ast.AST) -> Iterator[tuple]:
    """Yield how the parts of a node may be replaced, as `_of_node` does."""
    for name, value in ast.iter_fields(node):
        for k, each in enumerate(value if isinstance(value, list) else [value]):
            place, key = (value, k) if isinstance(value, list) else (node, name)
            if isinstance(each, ast.UnaryOp):
                yield place, key, each.operand, f"{type(each.op).__name__} removed"
            elif isinstance(each, ast.Call) and ast.unparse(each.func).endswith("outward"):
                exact = ast.Name("Interval" if isinstance(each.func, ast.Name) else "iv.Interval")
                yield place, key, ast.Call(exact, each.args[:2], []), "not rounded"
            elif isinstance(each, ast.Call) and ast.unparse(each.func).endswith("nextafter"):
                yield place, key, each.args[0], "not rounded"
            elif _can_be_left_out(each):
                yield place, key, ast.copy_location(ast.Pass(), each), "left out"


def _can_be_left_out(node) -> bool:
    if isinstance(node, ast.Expr):
        return not isinstance(node.value, ast.Constant | ast.Yield)
    places = isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript)
    return places or isinstance(node, ast.AugAssign | ast.Raise | ast.Continue | ast.Break)


def mutants(module: str) -> list[Mutant]:
    """Return all mutants of a module. Changes that leave its text the same are none."""
    text = (ROOT / module).read_text(encoding="utf-8")
    lines, found = text.splitlines(), []
    if module.endswith(".h"):
        code = re.sub(r"/\*.*?\*/", lambda c: re.sub(r"[^\n]", "\0", c[0]), text, flags=re.S)
        for pattern, new in CONFIGURATION["in_c"]:
            for hit in re.finditer(pattern, code):
                k = code.count("\n", 0, hit.start())
                source = text[: hit.start()] + new + text[hit.end() :]
                found.append((k + 1, f"{hit[0].strip()} -> {new.strip()}", source))
    else:
        tree = ast.parse(text)
        found = [(number, what, ast.unparse(tree)) for number, what in changes(tree)]
        text = ast.unparse(ast.parse(text))
    unlike = {source: (number, what) for number, what, source in reversed(found) if source != text}
    return [Mutant(module, n, lines[n - 1].strip(), w, s) for s, (n, w) in unlike.items()][::-1]
