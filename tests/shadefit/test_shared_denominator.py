"""Quantities with one denominator: the fit, the tables, and the function that computes it once."""

import json

import numpy as np
import pytest

from shadefit import Axis, Problem, closed_form, fit_with_shared_denominator, powers, samples
from shadefit.cli import main

X = np.linspace(0, 2, 60)
BELOW = 1 + 0.5 * X + 0.25 * X * X
ABOVE = {"r": 1 + X, "g": 2 - 0.5 * X, "b": 0.25 + 0.75 * X}


def quantities(noise: float = 0.0) -> list[Problem]:
    random = np.random.default_rng(6)
    return [
        Problem(name, [Axis("x", 0, 2)], samples(X, top / BELOW + noise * random.normal(size=60)))
        for name, top in ABOVE.items()
    ]


@pytest.mark.parametrize("norm", ["l2", pytest.param("linf", marks=pytest.mark.slow)])
def test_a_fit_finds_the_numerators_and_the_denominator_that_made_the_data(norm):
    found = fit_with_shared_denominator(quantities(), powers(1), powers(2), norm=norm)
    for result, top in zip(found, ([1, 1], [2, -0.5], [0.25, 0.75]), strict=True):
        expected = [*top, 0.5, 0.25]
        np.testing.assert_allclose(result.fit.fitted.coefficients, expected, rtol=1e-6)
        assert result.fit.certificate.bound > 0
        assert result.table.uncertainty is None
        assert result.table.provenance is not None
        assert "all 3 with one denominator" in result.table.provenance.solver


@pytest.mark.slow
def test_the_denominator_is_equal_to_the_last_bit_and_costs_little_accuracy():
    own = quantities(noise=1e-3)
    found = fit_with_shared_denominator(own, powers(1), powers(2), rounding="float32")
    assert len({tuple(r.fit.fitted.constants[2:].tolist()) for r in found}) == 1
    assert all(r.errors.rms < 1.5e-3 for r in found)
    # One least squares problem for each by itself can only be better.
    for result, problem in zip(found, quantities(noise=1e-3), strict=True):
        problem.rational(powers(1), powers(2), name="alone")
        assert problem.fit("alone").fit.on_grid.rms <= result.fit.on_grid.rms * (1 + 1e-6)


@pytest.mark.slow
def test_functions_are_fitted_together_too():
    lower, upper = (
        Problem(name, [Axis("x", 0.0, 1.0)], closed_form(call))
        for name, call in {"s": lambda x: 1 / (1 + x), "t": lambda x: (2 + x) / (1 + x)}.items()
    )
    found = fit_with_shared_denominator([lower, upper], powers(1), powers(1))
    assert [r.errors.largest < 1e-9 for r in found] == [True, True]


@pytest.mark.parametrize(
    ("count", "below", "message"),
    [
        (1, (0, 1), "1 quantities: a denominator is shared by at least 2"),
        (2, (1, 2), "the denominator has no constant"),
    ],
)
def test_what_cannot_be_shared_is_refused(count, below, message):
    with pytest.raises(ValueError, match=message):
        fit_with_shared_denominator(quantities()[:count], powers(1), below)


def test_other_axes_are_refused():
    other = Problem("other", [Axis("x", 0, 3)], samples(X, X))
    with pytest.raises(ValueError, match="other: allowed are the axes and domains of the others"):
        fit_with_shared_denominator([quantities()[0], other], powers(1), powers(1))


@pytest.fixture
def run(capsys):
    def run(*arguments, status: int = 0) -> str:
        with pytest.raises(SystemExit) as ended:
            main([str(each) for each in arguments])
        output = capsys.readouterr()
        assert ended.value.code == status, output.err
        return output.err if status else output.out

    return run


@pytest.fixture
def tables(run, tmp_path):
    """The tables of three columns, whose denominators are equal."""
    rows = np.column_stack([X, *(top / BELOW for top in ABOVE.values())])
    np.savetxt(tmp_path / "rgb.csv", rows, delimiter=",", header="x,R,G,B", comments="")
    given = ["--x", "x", "--y", "R,G,B", "--form", "rational:1,2", "--rounding", "float32"]
    run("fit", tmp_path / "rgb.csv", *given, "--shared-denominator", "--out", tmp_path)
    return [tmp_path / f"{name}.json" for name in ABOVE]


def test_the_command_writes_tables_and_one_function_divides_by_one_denominator(
    run, tables, tmp_path
):
    contents = [json.loads(path.read_text()) for path in tables]
    assert len({tuple(each["coefficients"][2:]) for each in contents}) == 1
    assert all("--shared-denominator" in each["provenance"]["command"] for each in contents)
    code = run("export", *tables, "--together", "Colour", "--to", "python")
    assert code.count("def ") == 1
    assert "Cost of all together: Colour: " in code
    # The sum of the denominator is there once, and three values are divided by it.
    assert (code.count("    sum = "), code.count(" / sum")) == (1, 3)
    made: dict = {}
    exec(code, made)
    values = made["Colour"](np.float32(X))
    for value, top in zip(values, ABOVE.values(), strict=True):
        np.testing.assert_allclose(value, top / BELOW, rtol=0, atol=1e-5)
    glsl = run("export", *tables, "--together", "Colour", "--to", "glsl")
    assert "out float values[3]" in glsl


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--form", "polynomial:2"], "allowed with --shared-denominator is one, rational:M,N"),
        (["--form", "rational:2"], "allowed are 2 numbers after rational:"),
        (["--form", "rational:1,1", "--side", "below"], "--side: allowed with --shared"),
        (["--form", "rational:1,1", "--name", "rgb"], "names and a second opinion are for one"),
    ],
)
def test_the_command_refuses_what_cannot_be_shared(run, tmp_path, options, message):
    (tmp_path / "rg.csv").write_text("x,R,G\n" + "".join(f"{x},{x},{1 - x}\n" for x in range(9)))
    given = ["--x", "x", "--y", "R,G", "--shared-denominator", *options]
    assert message in run("fit", tmp_path / "rg.csv", *given, status=2)


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["best/q-9"], "together 'All' is of one table"),
        (["best/q-9", "best/g-9"], "has other arguments or domains than"),
        (["best/ps-11", "best/q-9"], "FuzzPs is one of two functions"),
    ],
)
def test_only_functions_of_the_same_arguments_are_joined(run, names, message):
    assert message in run("export", *names, "--together", "All", "--to", "c", status=2)
