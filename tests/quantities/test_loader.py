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


def test_a_file_that_cannot_be_read_is_refused_in_one_line(tmp_path, monkeypatch):
    path = tmp_path / "mine.py"
    path.touch()

    def refuse(_):
        raise PermissionError(13, "Permission denied", "mine.py")

    monkeypatch.setattr("pathlib.Path.read_bytes", refuse)
    with pytest.raises(ValueError, match=r"mine\.py cannot be read: Permission denied$"):
        load_problems(str(path))


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


@pytest.mark.parametrize("ends", ["sys.exit()", "sys.exit('bye')", "raise GeneratorExit"])
def test_a_file_that_ends_the_program_is_an_error(tmp_path, ends):
    (tmp_path / "mine.py").write_text(f"import sys\nimport os\n{ends}\n")
    with pytest.raises(ProblemFileError, match=r"line 3"):
        load_problems(str(tmp_path / "mine.py"))


def test_a_file_that_removes_its_own_module_is_told_its_own_error(tmp_path):
    (tmp_path / "mine.py").write_text("import sys\ndel sys.modules[__name__]\n1 / 0\n")
    with pytest.raises(ProblemFileError, match="ZeroDivisionError"):
        load_problems(str(tmp_path / "mine.py"))


def test_what_a_file_prints_is_no_output_of_the_command(tmp_path, capsys):
    (tmp_path / "mine.py").write_text("print('hello')\n")
    with pytest.raises(ValueError, match="declares no quantity"):
        load_problems(str(tmp_path / "mine.py"))
    assert capsys.readouterr() == ("", "hello\n")


def test_a_relative_path_gives_the_lines_too(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text("def broken():\n    return 1 / 0\n\nbroken()\n")
    with pytest.raises(ProblemFileError, match="line 2, in broken"):
        load_problems("mine.py")
    (tmp_path / "axis.py").write_text(SHORT.format("").replace("0, 1", "1, 0"))
    with pytest.raises(ValueError, match=r"^axis\.py:3: x in \[1, 0\]: it is empty"):
        load_problems("axis.py")


def test_the_notes_of_jax_are_no_part_of_an_error(tmp_path):
    (tmp_path / "mine.py").write_text("import jax\njax.jit(lambda x: x if x > 0 else 1.0)(1.0)\n")
    with pytest.raises(ProblemFileError, match="line 2") as caught:
        load_problems(str(tmp_path / "mine.py"))
    assert "internal frames" not in str(caught.value)


def test_a_syntax_error_names_the_line(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text("x = = 1\n")
    with pytest.raises(ProblemFileError, match="line 1"):
        load_problems(str(path))


SHORT = """
from shadefit import Axis, Problem, closed_form
p = Problem("one", [Axis("x", 0, 1)], closed_form(lambda x: x * x){})
"""
MISUSE = {
    "a misspelt axis": (
        "@p.form\ndef line(y, c0):\n    return c0 * y\n",
        "mine.py:4: line(y, c0) begins with y: allowed are the axes x",
    ),
    "NaN in the reference": (
        "q = Problem('two', [Axis('x', 0, 1)], closed_form(lambda x: x / x))\n",
        "mine.py:4: lambda(x) is NaN at x = 0",
    ),
    "an operation that cannot be exported": (
        "import jax.numpy as jnp\n@p.form\ndef f(x, a):\n    return a * jnp.linalg.det(x)\n",
        "mine.py",
    ),
    "an empty domain": (
        "q = Problem('two', [Axis('x', 1, 0)], closed_form(lambda x: x))\n",
        "mine.py:4: x in [1, 0]: it is empty",
    ),
}


@pytest.mark.parametrize("case", MISUSE)
def test_misuse_in_a_file_is_told_with_its_line(tmp_path, case):
    more, message = MISUSE[case]
    path = tmp_path / "mine.py"
    path.write_text(SHORT.format("") + more)
    with pytest.raises((ValueError, ProblemFileError)) as caught:
        load_problems(str(path))
    assert message in str(caught.value)
    assert "/quantities/" not in str(caught.value)


@pytest.mark.parametrize(
    ("published", "message"),
    [
        ("Published('none', [1.0], 'a paper')", "form 'none' is not known: allowed are line"),
        ("Published('line', [1.0, 2.0], 'a paper')", "2 given, form 'line' has 1 coefficients"),
    ],
)
def test_published_constants_of_no_form_are_refused(tmp_path, published, message):
    path = tmp_path / "mine.py"
    text = SHORT.format(f", published=[{published}]").replace(
        "import Axis", "import Published, Axis"
    )
    path.write_text(text + "p.form(lambda x, a: a * x, name='line')\n")
    with pytest.raises(ValueError, match=r"mine\.py: published constants of one") as caught:
        load_problems(str(path))
    assert message in str(caught.value)


def test_data_beside_the_file_are_found(tmp_path, monkeypatch):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "data.csv").write_text("x,y\n0,1\n1,2\n")
    path = tmp_path / "folder" / "mine.py"
    path.write_text(
        "from shadefit import Axis, Problem, table\n"
        "p = Problem('one', [Axis('x', 0, 1)], table('data.csv', x=['x'], y='y'))\n"
    )
    monkeypatch.chdir(tmp_path)
    (problem,) = load_problems(str(path))
    assert problem.reference.data.values.tolist() == [1, 2]
    unregister("one")
