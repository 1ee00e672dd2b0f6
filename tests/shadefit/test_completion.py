"""What a shell completes: what there is, and without waiting for JAX."""

import subprocess
import sys

import pytest

from coefficients.catalogue import AS_PRINTED, exported_functions, names, resolve
from coefficients.packaged import FUNCTIONS
from programs import LANGUAGES
from quantities import problems
from shadefit import completion
from shadefit.commands.selection import ALL, selection


def test_the_names_that_are_repeated_are_the_real_ones():
    assert list(completion.QUANTITIES) == list(problems())
    exact = [f"exact/{p.name}" for p in problems().values() if p.exact_code is not None]
    assert list(completion.EXACT) == exact
    assert list(completion.FUNCTIONS) == list(exported_functions())
    assert {name.partition("/")[0] for name in exported_functions()} == set(FUNCTIONS)


def test_all_that_there_is_is_completed():
    assert completion.complete_quantity("") == [*problems(), ALL]
    tables = [name for name in names() if not name.endswith(AS_PRINTED)]
    assert sorted(completion.complete_table("")) == sorted(tables)
    others = [*completion.EXACT, *completion.FUNCTIONS]
    assert completion.complete_shader("") == [*completion.complete_table(""), *others]
    assert completion.complete_language("") == list(LANGUAGES)


def test_what_is_completed_is_taken():
    for name in completion.complete_quantity(""):
        assert selection([name])
    for name in completion.complete_shader(""):
        assert resolve(name).functions()


@pytest.mark.parametrize(
    ("complete", "begun", "expected"),
    [
        (completion.complete_quantity, "a", [ALL]),
        (completion.complete_table, "published/p", ["published/ps"]),
        (completion.complete_shader, "exact/p", ["exact/ps"]),
        (completion.complete_language, "c", ["c", "cpp", "cuda"]),
        (completion.complete_table, "zz", []),
    ],
)
def test_what_is_begun_is_ended(complete, begun, expected):
    assert complete(begun) == expected


def test_completion_does_not_wait_for_jax():
    code = (
        "import sys; from shadefit import cli, completion\n"
        "for each in ('quantity', 'table', 'shader', 'language'):\n"
        "    assert getattr(completion, f'complete_{each}')('')\n"
        "print('jax' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
