"""Problem files: what is loaded, and what is refused."""

import pytest

from quantities.loader import ProblemFileError, load_problems, option_for
from quantities.registry import problem, problems, unregister

DECLARATION = """
import jax.numpy as jnp
import shadefit as sf

X = sf.Axis("x", 0.0, 1.0)

@sf.leg(X)
def exact(x):
    return sf.Estimate(x * x, jnp.full((), 1e-16))

def declared(name):
    reference = sf.Reference(name, "S", "a square", "x²", (X,), sf.Sampling(5, 5, 5), exact)
    problem = sf.Problem(name, [X], reference, shader="Square")
    problem.form(lambda x, a: a * x, name="line")
    return problem

one, two = declared("one"), declared("two")
again = one
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(DECLARATION)
    yield path
    for name in ("one", "two"):
        unregister(name)


def test_all_quantities_of_a_file_are_registered(file):
    assert [each.name for each in load_problems(str(file))] == ["one", "two"]
    assert {"one", "two"} <= set(problems())
    assert option_for(problem("two")) == ["-p", str(file)]
    assert option_for(problem("q")) == []


def test_one_quantity_is_taken_by_its_name(file):
    assert [each.name for each in load_problems(f"{file}:two")] == ["two"]
    assert "one" not in problems()


def test_a_quantity_of_the_same_name_in_another_file_is_refused(file, tmp_path):
    load_problems(str(file))
    other = tmp_path / "other.py"
    other.write_text(DECLARATION)
    with pytest.raises(ValueError, match="a quantity is called 'one' already"):
        load_problems(str(other))


def test_a_file_that_is_loaded_again_replaces_what_it_declared(file):
    first = load_problems(str(file))
    second = load_problems(f"{file}:two")
    assert second[0] is not first[1]
    assert problems()["two"] is second[0]
    assert "one" not in problems()


@pytest.mark.parametrize(
    ("text", "named", "message"),
    [
        ("", "mine.py", "declares no quantity"),
        ("x = 1", "mine.py", "declares no quantity"),
        (DECLARATION, "mine.py:three", "declares no 'three': allowed are one, two"),
        (DECLARATION, "other.py", "other.py is no problem file"),
        (DECLARATION, "mine.txt", "is no problem file: allowed is a Python file"),
    ],
)
def test_what_is_no_problem_file_is_refused_in_one_line(tmp_path, text, named, message):
    (tmp_path / "mine.py").write_text(text)
    (tmp_path / "mine.txt").write_text(text)
    with pytest.raises(ValueError, match=message) as caught:
        load_problems(str(tmp_path / named))
    assert "\n" not in str(caught.value)


def test_an_error_of_the_file_is_shown_by_its_own_lines_alone(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text("def broken():\n    return 1 / 0\n\nbroken()\n")
    with pytest.raises(ProblemFileError) as caught:
        load_problems(str(path))
    text = str(caught.value)
    assert "line 4" in text
    assert "line 2, in broken" in text
    assert text.endswith("ZeroDivisionError: division by zero")
    assert "loader.py" not in text
    assert "importlib" not in text


def test_a_syntax_error_names_the_line(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text("x = = 1\n")
    with pytest.raises(ProblemFileError, match="line 1"):
        load_problems(str(path))
