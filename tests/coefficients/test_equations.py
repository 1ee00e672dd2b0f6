"""The equation of every form, read by a parser of its own: it gives the form's values."""

import itertools
import re

import numpy as np
import pytest

from coefficients.catalogue import entries, resolve
from coefficients.code_equation import code_equation
from coefficients.code_options import CodeOptions, shaped
from coefficients.json_text import WIDTH
from fitting import Form
from fitting.equation import coefficient_symbols, with_names
from fitting.linearity import program_of
from programs import evaluate
from programs.printing.identifiers import ascii_text
from programs.toolchains.verification import corners
from quantities import problem
from tests.coefficients.equation_reader import value_of

TABLES = [entry.name for entry in entries()]
# The same operations in another order: rounding of some values of the size of one.
ROUNDING = 1e-12
POINTS = 60


def points_of(form: Form, count: int = POINTS) -> np.ndarray:
    columns = np.random.default_rng(len(form.equation)).random((count, len(form.axes)))
    inner = [axis.place(u) for axis, u in zip(form.axes, columns.T, strict=True)]
    return np.stack(inner, axis=1)


def values_of_equation(form: Form, coefficients: np.ndarray, points: np.ndarray) -> np.ndarray:
    flat = np.ravel(coefficients).tolist()
    symbols = coefficient_symbols(form.coefficient_names)
    own = dict(zip(symbols, flat, strict=True)) if symbols and symbols[0] != "C[0]" else {}
    found = []
    for point in points.tolist():
        place = {axis.symbol: x for axis, x in zip(form.axes, point, strict=True)}
        found.append(value_of(form.equation, {**own, **place}, flat))
    return np.array(found)


def require_same(form: Form, coefficients: np.ndarray, points: np.ndarray) -> None:
    flat = np.tile(np.ravel(coefficients), (len(points), 1))
    expected = evaluate(program_of(form), np.concatenate([flat, points], axis=1))[:, 0]
    assert np.isfinite(expected).all()
    found = values_of_equation(form, coefficients, points)
    size = np.maximum(np.abs(expected), 1.0)
    assert np.max(np.abs(found - expected) / size) <= ROUNDING


@pytest.mark.parametrize("name", TABLES)
def test_the_equation_gives_the_values_of_the_table(name):
    fitted = resolve(name).require_fitted()
    require_same(fitted.form, fitted.constants, points_of(fitted.form))


@pytest.mark.parametrize("name", TABLES)
def test_the_equation_has_the_limits_that_corners_need(name):
    fitted = resolve(name).require_fitted()
    require_same(fitted.form, fitted.constants, corners(fitted.axes))


def require_same_of_candidates(quantity: str, every: int) -> None:
    for form in itertools.islice(problem(quantity).candidates({"alpha": 0.15}), 0, None, every):
        require_same(form, form.starts[0] + 0.01, points_of(form, 5))


@pytest.mark.parametrize("quantity", ["q", "g"])
def test_the_equations_of_a_search_give_the_values_of_their_forms(quantity):
    require_same_of_candidates(quantity, every=3)


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["q", "g", "ps"])
def test_the_equation_of_every_form_of_a_search_gives_its_values(quantity):
    require_same_of_candidates(quantity, every=1)


@pytest.mark.parametrize(
    ("family", "own"),
    [
        ("one-root-ps", {"skew": 0}),
        ("one-root-ps", {"skew": 1}),
        ("two-root-ps", {"terms": 4}),
        ("cubic-ps", {"steps": 0}),
    ],
)
def test_a_form_of_p_s_without_surfaces_has_an_equation_too(family, own):
    form = problem("ps").find_form(family, {**own, "degree": 0, "least_alpha": 0.15})
    require_same(form, 0.5 * form.starts[0] + 0.01, points_of(form, 5))


@pytest.mark.parametrize("variable", ["1-alpha", "1-alpha^2", "(1-alpha)/(1+alpha)"])
def test_the_equation_of_r_has_each_of_its_variables(variable):
    numerator, denominator = [[0, 0], [0, 1], [2, 1]], [[1, 0], [1, 2]]
    shape = {
        "variable": variable,
        "numerator": numerator,
        "denominator": denominator,
        "least_alpha": 0.15,
    }
    form = problem("r").find_form("monomial-r", shape)
    require_same(form, np.array([0.3, -0.2, 0.7, 0.4, -0.1]), points_of(form))


@pytest.mark.parametrize("name", TABLES)
def test_equations_are_short_and_in_ascii_still_the_same_formula(name):
    form = resolve(name).require_fitted().form
    assert len(form.equation) <= 12 * WIDTH
    plain = ascii_text(form.equation)
    assert "?" not in plain
    assert not re.search(r"sqrt(?!\()", plain)


@pytest.mark.parametrize("name", TABLES)
def test_the_equation_above_code_has_the_names_of_the_arguments(name):
    entry = resolve(name)
    text = code_equation(entry)
    for argument, _ in entry.problem.calling.second:
        assert f" = {argument};" in text
    words = set(re.findall(r"[^\W\d⁰¹²³⁴⁵⁶⁷⁸⁹][^\W⁰¹²³⁴⁵⁶⁷⁸⁹]*", text.partition("; C[0]")[0]))
    assert {argument.name for argument in entry.problem.calling.arguments} <= words
    gone = {axis.symbol for axis in entry.axes} - {a.name for a in entry.problem.calling.arguments}
    assert not words & (gone - {"d"})
    assert f"table {name}" in text


def test_the_equation_above_code_that_takes_cosines_has_cosines():
    entry = shaped(resolve("best/r-45"), CodeOptions(cosines=True))
    assert code_equation(entry).startswith("g = NdotT; b = 1 − alpha; ")


def test_names_are_replaced_whole_and_at_once():
    text = "c = cos(θ); x = c·θ; y = x·xx"
    assert with_names(text, {"x": "xx", "θ": "x"}, ["NdotU"]) == "c = NdotU; xx = c·x; y = xx·xx"


@pytest.mark.parametrize(
    ("names", "symbols"),
    [
        (["c0: d", "c1: d²"], ["c0", "c1"]),
        (["t", "p β"], ["C[0]", "C[1]"]),
        (["u: 1", "u: y"], ["C[0]", "C[1]"]),
        ([["c0: t", "c0: p"], ["c1: t", "c1: p"]], ["C[0]", "C[1]", "C[2]", "C[3]"]),
        ([], []),
    ],
)
def test_coefficients_have_their_own_names_if_these_are_different_words(names, symbols):
    assert coefficient_symbols(names) == symbols


@pytest.mark.parametrize(
    "equation",
    [
        "y = x z",
        "y = 2·missing",
        "y = x; y = 2·x",
        "y = √x·(",
        "y = (x; z = y",
        "y = x·",
        "y = C[1]",
        "y = x(2)",
        "a polynomial of 1 terms",
    ],
)
def test_the_reader_refuses_what_is_no_equation(equation):
    with pytest.raises((ValueError, IndexError)):
        value_of(equation, {"x": 2.0}, [1.0])


def test_the_reader_knows_the_grammar():
    text = "s(i) = C[i]·x² − C[i+1]; t = −x²/4 + max(√(x), ln(exp(1)))·s(1)³; y = t − 2 − 1"
    assert value_of(text, {"x": 4.0}, [0.0, 0.5, 7.0]) == -4 + 2 * (0.5 * 16 - 7.0) ** 3 - 3
