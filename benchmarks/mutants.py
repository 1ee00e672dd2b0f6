"""How many small changes of the code do its tests notice? `python benchmarks/mutants.py`.

A mutant is a copy of a module with one change: another comparison or operator, a constant that is
larger by one, a negated condition, `and` for `or`, `min` for `max`. Its tests are run in a process
of its own, in a copy of the project. If they pass, the mutant survives: the tests do not hold what
was changed, or the change makes no difference. Mutants are drawn at random, the same ones for the
same seed. Processes are forked from one that has imported JAX already, which needs a Unix.
"""

import argparse
import ast
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import jax  # noqa: F401  so that no child has to import it
import pytest
import scipy.optimize  # noqa: F401

ROOT = Path(__file__).parents[1]
FOLDERS = ("shading", "integrals", "programs", "fitting", "quantities", "coefficients", "shadefit")
# Name -> modules, their tests, and tests of these files that are too slow here
GROUPS = {
    "bounding": (
        [f"programs/bounding/{name}.py" for name in ("arithmetic", "interval", "denominators")],
        ["tests/programs/test_interval.py", "tests/programs/test_denominators.py"],
        "",
    ),
    "json": (
        [f"coefficients/{name}.py" for name in ("expression", "table_parts", "json_text")],
        [f"tests/coefficients/test_{name}.py" for name in ("expression", "table", "json_text")],
        "not survives_writing and not mutated_tables and not cut_and_patched",
    ),
}
# A mutant may loop for ever: then it is noticed too.
TIME_LIMIT = 180.0

_COMPARISONS = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
}  # fmt: skip
_OPERATORS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip
_NAMES = {"min": "max", "max": "min", "any": "all", "all": "any", "minimum": "maximum"}
_NAMES |= {"maximum": "minimum", "floor": "ceil", "ceil": "floor"}


def changes(tree: ast.AST) -> Iterator[tuple[str, str, ast.AST]]:
    """Yield a place, what is changed there, and the tree while it is changed."""
    hints = {
        id(part) for node in ast.walk(tree) for hint in _hints(node) for part in ast.walk(hint)
    }
    for node in ast.walk(tree):
        if id(node) in hints:
            continue
        where = f"line {getattr(node, 'lineno', '?')}"
        if isinstance(node, ast.Compare):
            for k, operator in enumerate(node.ops):
                node.ops[k] = _COMPARISONS[type(operator)]()
                yield where, f"{type(operator).__name__} -> {type(node.ops[k]).__name__}", tree
                node.ops[k] = operator
        elif isinstance(node, ast.BinOp | ast.BoolOp) and type(node.op) in _OPERATORS:
            old = node.op
            node.op = _OPERATORS[type(old)]()
            yield where, f"{type(old).__name__} -> {type(node.op).__name__}", tree
            node.op = old
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            old = node.value
            node.value = old + 1
            yield where, f"{old} -> {old + 1}", tree
            node.value = old
        elif isinstance(node, ast.If | ast.IfExp | ast.While):
            old = node.test
            node.test = ast.UnaryOp(ast.Not(), old)
            yield where, "condition negated", tree
            node.test = old
        elif isinstance(node, ast.Name) and node.id in _NAMES:
            old = node.id
            node.id = _NAMES[old]
            yield where, f"{old} -> {node.id}", tree
            node.id = old
        elif isinstance(node, ast.Attribute) and node.attr in _NAMES:
            old = node.attr
            node.attr = _NAMES[old]
            yield where, f".{old} -> .{node.attr}", tree
            node.attr = old


def _hints(node: ast.AST) -> list[ast.AST]:
    # Types are read by people and by tests' type checker. They compute nothing.
    found = [getattr(node, name, None) for name in ("annotation", "returns")]
    return [each for each in found if isinstance(each, ast.AST)]


def mutants(modules: list[str]) -> list[tuple[str, str, str, str]]:
    """Return all mutants of modules: the module, the place, the change and the source."""
    found = []
    for module in modules:
        tree = ast.parse((ROOT / module).read_text(encoding="utf-8"))
        for where, what, changed in changes(tree):
            source = ast.unparse(ast.fix_missing_locations(changed))
            found.append((module, where, what, source))
    return found


def passes(folder: Path, tests: list[str], left_out: str) -> bool:
    """Run tests in a copy of the project, in a child process; return whether they passed."""
    child = os.fork()
    if child == 0:
        os.setsid()
        os.chdir(folder)
        sys.path.insert(0, str(folder))
        quiet = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(quiet, stream)
        given = ["-x", "-q", "-p", "no:cacheprovider", "-o", "addopts=--import-mode=importlib"]
        given += ["-m", "not slow and not wheel", "-k", left_out, *tests]
        os._exit(min(int(pytest.main(given)), 125))
    end = time.monotonic() + TIME_LIMIT
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status) == 0
        time.sleep(0.05)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return False


def score(name: str, count: int, seconds: float, seed: int) -> tuple[int, int, list[str]]:
    """Run mutants of a group. Returns how many were noticed, how many were run, and the others."""
    modules, tests, left_out = GROUPS[name]
    tests = [each for each in tests if (ROOT / each).is_file()]
    drawn = mutants(modules)
    random.Random(seed).shuffle(drawn)
    sys.dont_write_bytecode = True
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for each in (*FOLDERS, "tests"):
            shutil.copytree(ROOT / each, folder / each)
        shutil.copy(ROOT / "pyproject.toml", folder)
        if not passes(folder, tests, left_out):
            raise SystemExit(f"{name}: the tests fail without any change")
        noticed, survivors, end = 0, [], time.monotonic() + seconds
        for module, where, what, source in drawn[:count]:
            if time.monotonic() > end:
                break
            path = folder / module
            original = path.read_bytes()
            path.write_text(source, encoding="utf-8")
            if passes(folder, tests, left_out):
                survivors.append(f"{module}, {where}: {what}")
                print(f"    survived: {survivors[-1]}", flush=True)
            else:
                noticed += 1
            path.write_bytes(original)
            shutil.copystat(ROOT / module, path)
    return noticed, noticed + len(survivors), survivors


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=60, help="mutants of each group")
    parser.add_argument("--seconds", type=float, default=1800.0, help="time limit of each group")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("groups", nargs="*", default=list(GROUPS), choices=[*GROUPS, []])
    options = parser.parse_args()
    for name in options.groups:
        total = len(mutants(GROUPS[name][0]))
        print(f"{name}: {total} mutants, of which {min(options.count, total)} are drawn")
        noticed, run, _ = score(name, options.count, options.seconds, options.seed)
        print(f"{name}: {noticed} of {run} mutants are noticed ({100 * noticed / run:.0f} %)")


if __name__ == "__main__":
    main()
