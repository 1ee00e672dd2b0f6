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
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path

import hypothesis
import jax  # noqa: F401  so that no child has to import it
import mpmath  # noqa: F401
import pydantic  # noqa: F401
import pytest
import scipy.optimize  # noqa: F401
from mutations import CONFIGURATION, ROOT, mutants

FOLDERS = ("shading", "integrals", "programs", "fitting", "quantities", "coefficients", "shadefit")


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
        given = "-x -q -p no:cacheprovider --assert=plain -o addopts=--import-mode=importlib"
        chosen = ["-m", "not slow and not wheel", "-k", CONFIGURATION["but"], *tests]
        status = pytest.main([*given.split(), *chosen], plugins=[Quick()])
        os._exit(min(int(status), 125))
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
    known = {tuple(each[:3]) for each in CONFIGURATION["equal"]}
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
            rest = f", {equal} make no difference" if equal else ""
            print(f"{module}: {noticed} of {run} are noticed{rest}", flush=True)


if __name__ == "__main__":
    main()
