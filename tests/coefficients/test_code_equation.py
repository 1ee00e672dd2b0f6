"""The equation of every form, read by a parser of its own: it gives the form's values."""

import itertools
import re

import numpy as np
import pytest
from scipy.special import expn

from coefficients.catalogue import entries, resolve
from coefficients.code_equation import code_equation
from coefficients.code_options import CodeOptions, shaped
from coefficients.json_text import WIDTH
from coefficients.packaged import files
from coefficients.restate import restated
from coefficients.table import read, serialise
from programs.printing.identifiers import ascii_text
from programs.toolchains.verification import corners
from quantities import problem
from tests.equation_reader import NAME, points_of, points_of_axes, require_same, value_of

TABLES = [entry.name for entry in entries()]


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
    require_same(form, np.full(form.size, 0.1), points_of(form, 5))


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
    words = set(re.findall(NAME, text.partition("; C[0]")[0]))
    assert {argument.name for argument in entry.problem.calling.arguments} <= words
    gone = {axis.symbol for axis in entry.axes} - {a.name for a in entry.problem.calling.arguments}
    assert not words & (gone - {"d"})
    assert f"table {name}" in text


def test_the_equation_above_code_that_takes_cosines_has_cosines():
    entry = shaped(resolve("best/r-45"), CodeOptions(cosines=True))
    assert code_equation(entry).startswith("g = NdotT; b = 1 − alpha; ")


@pytest.mark.parametrize("name", files())
def test_a_packaged_table_has_the_equation_of_its_form_and_is_written_as_before(name):
    table, form = read(files()[name]), resolve(name).require_fitted().form
    assert table.equation == form.equation
    # To state the equations again changes no byte.
    assert serialise(restated(table, form)) == files()[name].read_text(encoding="utf-8")


def test_only_the_equation_is_restated():
    table = resolve("best/g-9").require_table()
    old = table.model_copy(update={"equation": "G by some formula"})
    assert restated(old, resolve("best/g-9").require_fitted().form) == table


def root_of(cos_un: float, cos_ut: float, cos_nt: float, alpha: float) -> float:
    """Return the positive root of the cubic in the closed form of P_s (docs/closed-form.md)."""
    kappa, m = 1 - alpha**2, alpha**2 * cos_un
    t = kappa * cos_ut * cos_nt
    s2 = (1 - kappa * cos_ut**2) * (1 - kappa * cos_nt**2)
    roots = np.roots([1, m + 2 * t, t * t - s2, -m])
    return max(roots.real[np.abs(roots.imag) < 1e-12])


KNOWN = {
    "ps": lambda *given: {"root": root_of(*given)},
    "g": lambda *_: {"E1": lambda x: expn(1, x), "E2": lambda x: expn(2, x)},
    "q": lambda *_: {"E3": lambda x: expn(3, x)},
    "velvet": lambda *_: {"π": np.pi, "asin": np.arcsin},
}


@pytest.mark.parametrize("quantity", KNOWN)
def test_the_equation_of_a_closed_form_gives_its_values(quantity):
    entry = resolve(f"exact/{quantity}")
    text = code_equation(entry).removeprefix("closed form: ").partition(", where")[0]
    (called,) = entry.functions("double")
    points = points_of_axes(entry.axes, 20)
    (columns,) = entry.arguments_at(points)
    names = [each.name for each in called.parameters]
    found = [
        value_of(text, {**dict(zip(names, row, strict=True)), **KNOWN[quantity](*row)}, [])
        for row in columns.tolist()
    ]
    np.testing.assert_allclose(found, entry.problem.reference.values(points), rtol=0, atol=1e-11)
