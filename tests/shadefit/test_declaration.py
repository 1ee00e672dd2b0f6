"""Quantities as a user declares them, and the results of their fits."""

import json

import jax.numpy as jnp
import numpy as np
import pytest
from matplotlib.figure import Figure

import shadefit as sf
from coefficients.catalogue import resolve
from programs import LANGUAGES
from quantities.registry import unregister

X = sf.Axis("x", 0, 4)


@pytest.fixture(scope="module")
def tanh():
    problem = sf.Problem("tanhc", [X], sf.closed_form(jnp.tanh))
    problem.form(
        lambda x, a, b, c: x * (a + b * x * x) / (1 + c * x * x), name="pade", start=[1, 0.1, 0.4]
    )
    return problem


@pytest.fixture(scope="module")
def result(tanh):
    return tanh.fit("pade", norm="linf")


def test_a_notebook_cell_fits_and_shows_itself(result):
    assert list(result.coefficients) == ["a", "b", "c"]
    assert result.errors.largest < 5.3e-3
    assert result.least_error > 0.98 * result.errors.largest
    assert any("denominators ≥" in text for text in result.certificate)
    shown = repr(result)
    page = result._repr_html_()
    for text in ("tanhc by pade", "largest error", "denominators", "x·(a + b·x·x)"):
        assert text in shown
        assert text in page
    assert "<table" in page
    assert "\x1b" not in shown


def test_a_result_evaluates_its_form(result):
    a, b, c = result.coefficients.values()
    x = np.array([[0.0, 0.5], [1.0, 4.0]])
    np.testing.assert_allclose(
        result(x), x * (a + b * x * x) / (1 + c * x * x), rtol=1e-14, atol=1e-16
    )


@pytest.mark.parametrize(
    "language",
    [
        each if each in ("c", "hlsl", "python") else pytest.param(each, marks=pytest.mark.slow)
        for each in LANGUAGES
    ],
)
def test_a_result_writes_code_with_what_is_known(result, language):
    text = result.code(language)
    assert "Tanhc" in text
    assert "against the exact values" in text
    assert f"tanhc.fit('pade', norm='linf').code('{language}')" in text


def test_a_result_draws_itself(result):
    figure = result.plot()
    assert isinstance(figure, Figure)
    assert len(figure.axes) == 2


def test_a_saved_result_needs_no_problem(result, tmp_path):
    path = result.save(tmp_path / "mine.json")
    entry = resolve(str(path))
    assert entry.problem.symbol == "tanhc"
    assert entry.problem.calling.name == "Tanhc"
    assert float(entry.require_fitted()(0.7)) == pytest.approx(float(result(0.7)), rel=1e-15)
    assert json.loads(path.read_text())["about"]["arguments"] == {"x": "x"}


def test_a_closed_form_of_known_operations_is_code_too(tanh):
    assert tanh.exact_code is not None
    loop = sf.Problem("loop", [X], sf.closed_form(lambda x: jnp.sort(jnp.stack([x, x * x]))[0]))
    assert loop.exact_code is None


def test_published_constants_are_compared_with():
    line = sf.Problem(
        "line",
        [X],
        sf.closed_form(lambda x: 2 * x),
        published=[sf.Published("slope", [1.9], "a paper")],
    )
    line.form(lambda x, a: a * x, name="slope")
    sf.register(line)
    entry = resolve("published/line")
    assert entry.kind == "published"
    assert entry.require_table().publication.source == "a paper"
    assert float(entry.require_fitted()(1.0)) == 1.9
    unregister("line")


def test_a_weight_multiplies_errors():
    def parabola(weight=None):
        problem = sf.Problem("p", [X], sf.closed_form(lambda x: x * x), weight=weight)
        problem.form(lambda x, a: a * x, name="slope")
        return problem.fit().coefficients["a"]

    # ∫ w² x³ / ∫ w² x² over [0, 4]: 3 for w = 1 and 10/3 for w² = x.
    assert parabola() == pytest.approx(3, rel=2e-3)
    assert parabola(jnp.sqrt) == pytest.approx(16 / 5, rel=2e-3)


def test_arrays_of_coefficients_have_numbered_names():
    problem = sf.Problem("q", [X], sf.closed_form(lambda x: 1 + 2 * x))
    problem.form(lambda x, c: c[0] + c[1] * x, name="line", sizes={"c": 2})
    found = problem.fit("line").coefficients
    assert found == pytest.approx({"c0": 1, "c1": 2}, abs=1e-9)


def strange(y, c0):
    return c0 * y


CASES = {
    "misspelt axis": (
        lambda p: p.form(strange),
        r"test_declaration.py:\d+: strange\(y, c0\) begins with y: allowed are the axes x",
    ),
    "a nameless coefficient": (lambda p: p.form(lambda x, *c: x), r"\*c has no name"),
    "starts": (lambda p: p.form(lambda x, a: a * x, start=[1, 2]), "2 starts given for 1 coeff"),
    "an operation": (
        lambda p: p.form(lambda x, a: a * jnp.sort(jnp.stack([x, x * x]))[0], name="s"),
        "'sort' in .* cannot be written as shader code",
    ),
    "a second of one name": (
        lambda p: [p.form(lambda x, a: a * x, name="twice") for _ in range(2)],
        "p has a form 'twice': allowed is another name",
    ),
    "an unknown form": (lambda p: p.fit("none"), "form 'none' is not known"),
    "no form": (lambda p: p.fit(), "p has no form: add one"),
    "a domain of no axis": (
        lambda p: p.form(lambda x, a: a * x, domain={"z": (0, 1)}),
        "'z' is no axis: allowed are x",
    ),
    "a coefficient without effect": (
        lambda p: p.form(lambda x, a, b: a * x, name="f"),
        "f does not use its coefficient b",
    ),
    "a form that is no number": (
        lambda p: [p.form(lambda x, a: a * x * jnp.nan, name="nan"), p.fit("nan")],
        "nan: its coefficients cannot be found",
    ),
    "a relative error of 0": (
        lambda p: [p.form(lambda x, a: a * x, name="g"), p.fit("g", relative=True, norm="linf")],
        "p is 0 at x 0 and cannot be fitted there: allowed are finite values .*, but not 0",
    ),
    "sizes": (lambda p: p.form(lambda x, a: a * x, sizes={"b": 2}), "sizes of b = 2"),
}


@pytest.mark.parametrize("case", CASES)
def test_misuse_is_told_in_one_line(case):
    call, message = CASES[case]
    problem = sf.Problem("p", [X], sf.closed_form(lambda x: x * x))
    with pytest.raises(ValueError, match=message) as caught:
        call(problem)
    assert "\n" not in str(caught.value)


def test_a_reference_that_is_nan_at_a_corner_is_refused():
    with pytest.raises(ValueError, match=r"lambda\(x\) is NaN at x = 0"):
        sf.Problem("p", [X], sf.closed_form(lambda x: jnp.sin(x) / x))


def test_a_reference_of_complex_numbers_is_refused():
    with pytest.raises(ValueError, match=r"lambda\(x\) returns complex numbers"):
        sf.Problem("p", [X], sf.closed_form(lambda x: x + 1j))


def test_a_reference_that_is_infinite_where_it_is_fitted_is_named():
    problem = sf.Problem("p", [X], sf.closed_form(lambda x: 1 / x))
    problem.form(lambda x, a: a * x, name="line")
    with pytest.raises(ValueError, match=r"p is inf at x 0 and cannot be fitted there"):
        problem.fit("line", norm="linf")
    problem = sf.Problem("p", [X], sf.closed_form(lambda x: (1 + x) * 1e300))
    problem.form(lambda x, a: a * x, name="line")
    with pytest.raises(ValueError, match=r"allowed are finite values up to 1e\+150 in size"):
        problem.fit("line", norm="linf")


def test_an_argument_for_no_axis_is_refused():
    with pytest.raises(ValueError, match="arguments: 'y' is no axis: allowed are x"):
        sf.Problem("p", [X], sf.closed_form(jnp.tanh), arguments={"y": "why"})


def test_an_axis_may_have_the_name_of_anything_inside():
    axes = [sf.Axis("c", 0, 1), sf.Axis("v", 0, 1)]
    problem = sf.Problem("named", axes, sf.closed_form(lambda c, v: 1 + c + v))
    problem.polynomial(1)
    result = problem.fit()
    assert result.errors.largest < 1e-12
    assert "float Named(float c, float v)" in result.code("hlsl")


def test_an_axis_with_a_reserved_name_needs_another_one_in_the_shader():
    axes = [sf.Axis("float", 0, 1)]
    for arguments, refused in (({}, True), ({"float": "x"}, False)):
        problem = sf.Problem("named", axes, sf.closed_form(lambda x: x), arguments=arguments)
        problem.polynomial(1)
        result = problem.fit()
        if refused:
            with pytest.raises(ValueError, match="name 'float' cannot be used in HLSL"):
                result.code("hlsl")
        else:
            assert "float Named(float x)" in result.code("hlsl")
