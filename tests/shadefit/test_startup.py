"""What the command line does at once: help, lists, completion and refusals do not import JAX."""

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


def run(*arguments: str) -> tuple[int, str, str]:
    command = [sys.executable, "-c", CODE, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    *said, imported = done.stderr.splitlines()
    assert imported == "False", arguments
    return done.returncode, done.stdout, "\n".join(said)


@pytest.mark.parametrize(
    "arguments", [["--help"], ["refit", "--help"], ["list"], ["list", "--json"]]
)
def test_help_and_lists_do_not_wait_for_jax(arguments):
    status, out, _ = run(*arguments)
    assert status == 0
    assert out


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
