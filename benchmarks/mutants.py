"""How many small changes of the code do its tests notice? `python benchmarks/mutants.py`.

A mutant is a copy of a module with one change: another comparison, operator or constant, a negated
condition, the other one of two ends, a bound that is not rounded outwards, a statement that is left
out. Its tests are run in a process of its own, the nearest first, in a copy of the project. If they
pass, the mutant survives: the tests do not hold what was changed, or the change makes no
difference. `mutants.toml` has the tests of each module, and the changes that are known to make no
difference. Mutants are drawn at random, the same ones for the same seed. Processes are forked from
one that has imported the libraries already, which needs a Unix.
"""

import argparse
import ast
import os
import random
import re
import shutil
import signal
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import hypothesis
import jax  # noqa: F401  so that no child has to import it
import mpmath  # noqa: F401
import pydantic  # noqa: F401
import pytest
import scipy.optimize  # noqa: F401

ROOT = Path(__file__).parents[1]
FOLDERS = ("shading", "integrals", "programs", "fitting", "quantities", "coefficients", "shadefit")
CONFIGURATION = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))

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
    # Types are read by people and by the type checker. They and `strict` compute nothing.
    idle = [getattr(node, k, None) for node in ast.walk(tree) for k in ("annotation", "returns")]
    idle += [
        node for node in ast.walk(tree) if isinstance(node, ast.keyword) and node.arg == "strict"
    ]
    skipped = {id(part) for hint in idle if hint is not None for part in ast.walk(hint)}
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
        original = ast.unparse(ast.parse(text))
        found = [each for each in found if each[2] != original]
    unlike = {source: (number, what) for number, what, source in reversed(found)}
    return [Mutant(module, n, lines[n - 1].strip(), w, s) for s, (n, w) in unlike.items()][::-1]


class Quick:
    """A plugin of pytest: an example that fails is not made smaller."""

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection(self):
        phases = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
        quick = hypothesis.settings(hypothesis.settings.get_profile("repeatable"), phases=phases)
        hypothesis.settings.register_profile("quick", quick)
        hypothesis.settings.load_profile("quick")


def passes(folder: Path, tests: list[str], limit: float) -> bool:
    """Run tests in a copy of the project, in a child process; return whether they passed."""
    child = os.fork()
    if child == 0:
        os.setsid()
        os.chdir(folder)
        sys.path.insert(0, str(folder))
        quiet = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(quiet, stream)
        given = [
            "-x",
            "-q",
            "-p",
            "no:cacheprovider",
            "--assert=plain",
            "-o",
            "addopts=--import-mode=importlib",
        ]
        given += ["-m", "not slow and not wheel", "-k", CONFIGURATION["but"], *tests]
        os._exit(min(int(pytest.main(given, plugins=[Quick()])), 125))
    end = time.monotonic() + limit
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status) == 0
        time.sleep(0.02)
    # It may loop for ever: then it is noticed too.
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return False


def score(folder: Path, module: str, count: int, seed: int, limit: float) -> tuple[int, int, int]:
    """Run mutants of a module. Return how many were noticed, and run, and are known as equal."""
    tests = CONFIGURATION["tests"][module]
    drawn = mutants(module)
    random.Random(seed).shuffle(drawn)
    known = {(each["module"], each["line"], each["change"]) for each in CONFIGURATION["equal"]}
    noticed = equal = 0
    for mutant in drawn[:count]:
        if (module, mutant.line, mutant.change) in known:
            equal += 1
            continue
        (folder / module).write_text(mutant.source, encoding="utf-8")
        if passes(folder, tests, limit):
            print(f"    {module}:{mutant.number}: {mutant.change}    {mutant.line}", flush=True)
        else:
            noticed += 1
    shutil.copy2(ROOT / module, folder / module)
    return noticed, min(count, len(drawn)) - equal, equal


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20, help="mutants of each module")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=120.0, help="seconds for the tests of one")
    parser.add_argument("modules", nargs="*", default=list(CONFIGURATION["tests"]))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for each in (*FOLDERS, "tests", "examples", "docs"):
            shutil.copytree(ROOT / each, folder / each)
        shutil.copy(ROOT / "pyproject.toml", folder)
        for module in options.modules:
            if not passes(folder, CONFIGURATION["tests"][module], 600.0):
                raise SystemExit(f"{module}: the tests fail without any change")
            sys.dont_write_bytecode = True
            noticed, run, equal = score(folder, module, options.count, options.seed, options.limit)
            print(
                f"{module}: {noticed} of {run} are noticed, {equal} make no difference", flush=True
            )


if __name__ == "__main__":
    main()
