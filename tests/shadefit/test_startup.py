"""What the command line does at once: help, lists, tables as JSON and refusals do not import JAX.

The other commands import the quantity that they need, and no solvers before they fit.
"""

import subprocess
import sys

import pytest

CODE = """
import sys
from shadefit.cli import main
try:
    main(sys.argv[1:])
finally:
    print("jax" in sys.modules, file=sys.stderr)
"""
OTHERS = """
import sys
from shadefit.cli import main
slow = ("scipy", "optimistix", "lineax", "matplotlib", "quantities.skin", "quantities.fuzz.velvet")
try:
    main(["cost", "q"])
finally:
    print([name for name in slow if name in sys.modules], file=sys.stderr)
"""


def run(*arguments: str) -> tuple[int, str, str]:
    command = [sys.executable, "-c", CODE, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    *said, imported = done.stderr.splitlines()
    assert imported == "False", arguments
    return done.returncode, done.stdout, "\n".join(said)


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["list"], ["export", "best/q-9"], ["export", "published/ps@printed"]],
)
def test_help_and_lists_do_not_wait_for_jax(arguments):
    status, out, _ = run(*arguments)
    assert status == 0
    assert out


def test_a_command_imports_its_own_quantity_and_no_solver():
    done = subprocess.run(
        [sys.executable, "-c", OTHERS], capture_output=True, text=True, check=True
    )
    assert done.stderr == "[]\n"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["compare", "nope"], "no table is called 'nope': allowed are ps, g, q, r, velvet, ggx-"),
        (["export", "nope"], "no table is called 'nope'"),
        (["cost", "nope"], "no table is called 'nope'"),
        (["verify", "q", "nope"], "no table is called 'nope'"),
        (["verify", "q", "--to", "fortran"], "allowed: c, cpp"),
        (["export", "q", "--to", "fortran"], "allowed: c, cpp"),
        (["evaluate", "nope", "--density", "1"], "no integral is called 'nope': allowed are ps, g"),
        (["evaluate", "q", "--density", "1", "--table", "nope"], "no table is called 'nope'"),
        (["refit", "q", "nope"], "nothing is called 'nope': allowed are ps, g, q, r, velvet, ggx-"),
        (["search", "nope"], "no forms are known of 'nope': allowed are ps, g, q, r"),
    ],
)
def test_a_misspelt_name_is_refused_without_waiting_for_jax(arguments, said):
    status, out, error = run(*arguments)
    assert (status, out) == (2, "")
    assert said in error
    assert "\n" not in error


def test_a_command_runs_where_no_further_thread_is_allowed():
    code = """
import sys, threading
def refuse(thread):
    raise RuntimeError("can't start new thread")
threading.Thread.start = refuse
from shadefit.__main__ import main
sys.argv = ["shadefit", "--version"]
main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("shadefit ")
