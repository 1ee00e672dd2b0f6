"""Polynomials and quotients of them: values, operations, names, texts, and what is refused."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting.fit import fit
from fitting.linearity import linear_parts
from fitting.shapes import polynomial, powers, rational
from fitting.shapes.monomial_sums import nested_horner
from tests.fitting.lines import LINE, operations
from tests.fitting.toys import TOY

RANDOM = np.random.default_rng(3)
ETA, X, Y = 1.7, 0.3, -0.7


def test_powers_are_exponents_up_to_a_degree_in_each_variable_or_in_total():
    assert powers(2) == (0, 1, 2)
    assert powers(2, 2, total=True) == ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0))
    for degree, variables in ((4096, 1), (10**400, 1), (100, 2), (10**400, 3), (7, 5)):
        with pytest.raises(ValueError, match="allowed are at most 4096 monomials"):
            powers(degree, variables)
    assert len(powers(4095)) == 4096
    assert powers(1, 2) == ((0, 0), (0, 1), (1, 0), (1, 1))
    assert len(powers(2, 3)) == 27
    assert len(powers(2, 3, total=True)) == 10
    with pytest.raises(ValueError, match="allowed are 0 or more"):
        powers(-1)


@pytest.mark.parametrize(
    "exponents",
    [
        ((0,),),
        ((2,), (7,)),
        ((0,), (2,), (4,), (6,)),
        powers(3, 2, total=True),
        ((3, 0), (0, 4), (2, 2)),
        powers(2, 3),
        ((5, 1, 0), (0, 0, 2)),
    ],
)
def test_nested_horner_gives_the_sum_of_monomials(exponents):
    exponents = [e if isinstance(e, tuple) else (e,) for e in exponents]
    point = [0.7, -1.3, 0.4][: len(exponents[0])]
    c = RANDOM.normal(size=len(exponents))
    expected = sum(a * np.prod(np.power(point, e)) for a, e in zip(c, exponents, strict=True))
    found = nested_horner(dict(zip(exponents, c, strict=True)), point)
    assert float(found) == pytest.approx(float(expected), rel=1e-13)


def test_a_quotient_has_its_value_names_and_text():
    form = rational(LINE, powers(2)[1:], powers(2), name="r", of=lambda eta: eta - 1)
    assert form.coefficient_names == ["a1", "a2", "b1", "b2"]
    assert form.equation == "z = η − 1; f = (a1·z + a2·z²)/(1 + b1·z + b2·z²)"
    z = ETA - 1
    c = np.array([0.5, -0.3, 2.0, 0.7])
    expected = (0.5 * z - 0.3 * z**2) / (1 + 2 * z + 0.7 * z**2)
    assert float(form(c, ETA)) == pytest.approx(expected, rel=1e-14)
    # z, then z (a1 + a2 z)/(1 + z (b1 + b2 z)): 1 + 3 + 4 + 1.
    assert operations(form, c) == 9


def test_a_factor_and_a_summand_build_a_value_at_a_boundary_in():
    form = rational(
        TOY,
        powers(1, 2),
        ((0, 0), (1, 0)),
        name="edge",
        times=lambda x: x,
        plus=lambda y: 2 + jnp.sin(y),
    )
    c = RANDOM.uniform(0.5, 1, form.size)
    assert float(form(c, 0.0, Y)) == 2 + np.sin(Y)
    top = c[0] + c[1] * Y + c[2] * X + c[3] * X * Y
    expected = 2 + np.sin(Y) + X * top / (1 + c[4] * X)
    assert float(form(c, X, Y)) == pytest.approx(expected, rel=1e-14)
    assert form.equation.startswith(
        "f = 2 + sin(y) + x·(a00 + a01·y + a10·x + a11·x·y)/(1 + b10·x)"
    )
    assert linear_parts(form, np.array([[X, Y]])) is not None


def test_another_monomial_of_the_denominator_may_have_the_coefficient_one():
    some = powers(1, 2, total=True)
    form = rational(TOY, some, some, one=(0, 1), name="other")
    assert form.coefficient_names == ["a00", "a01", "a10", "b00", "b10"]
    c = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    expected = (1 + 2 * Y + 3 * X) / (4 + Y + 5 * X)
    assert float(form(c, X, Y)) == pytest.approx(expected, rel=1e-14)
    without = rational(LINE, (0,), (1, 2), name="without")
    assert without.coefficient_names == ["a0", "b2"]
    assert float(without(np.array([2.0, 0.5]), ETA)) == pytest.approx(2 / (ETA + 0.5 * ETA**2))


def test_several_variables_are_computed_from_the_axes():
    form = rational(TOY, powers(1, 2), ((0, 0), (2, 0)), name="of", of=lambda x, y: (x * x, -y))
    c = RANDOM.uniform(0.5, 1, form.size)
    z1, z2 = X * X, -Y
    top = c[0] + c[1] * z2 + c[2] * z1 + c[3] * z1 * z2
    assert float(form(c, X, Y)) == pytest.approx(top / (1 + c[4] * z1**2), rel=1e-14)
    assert form.equation.startswith("z1 = x²; z2 = −y; f = ")
    even = rational(TOY, (0, 1), (0, 1), name="even", of=lambda x: x * x)
    assert float(even(np.ones(3), 0.5, Y)) == float(even(np.ones(3), -0.5, Y))


@pytest.mark.parametrize(
    ("exponents", "least"),
    [
        ((0, 1, 2, 3), 6),
        ((0, 2, 4, 6), 7),
        ((0, 8), 5),
        # A product and a sum for each coefficient but the last.
        (powers(3, 2, total=True), 18),
        # The outer variable is y: c0 + c1 y + c2 y² + x y².
        (((0, 0), (0, 1), (0, 2), (1, 2)), 6),
    ],
)
def test_horner_needs_few_operations(exponents, least):
    reference = LINE if isinstance(exponents[0], int) else TOY
    form = polynomial(reference, exponents, name="p")
    assert operations(form, RANDOM.uniform(1, 2, form.size)) == least


def test_a_degree_stands_for_all_monomials_of_that_total_degree():
    form = polynomial(TOY, 2, name="p")
    assert form.coefficient_names == ["c00", "c01", "c02", "c10", "c11", "c20"]
    assert form.equation == "f = c00 + c01·y + c02·y² + c10·x + c11·x·y + c20·x²"
    assert polynomial(LINE, 2, name="p").equation == "f = c0 + c1·η + c2·η²"
    assert polynomial(LINE, (12, 3), name="p").coefficient_names == ["c12", "c3"]
    assert polynomial(TOY, [(12, 3)], name="p").coefficient_names == ["c12_3"]


def test_quotients_are_fitted_without_a_start_and_proven():
    form = rational(LINE, powers(2)[1:], powers(2), name="r", of=lambda eta: eta - 1)
    found = fit(form)
    assert found.certificate.holds
    # f(1) = 0 is built in.
    assert float(found.fitted(1.0)) == 0
    # Four coefficients. Least squares give 3.75e-5.
    assert found.off_grid.largest < 3.8e-5


def _named(eta, other):
    return eta * other


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rational(LINE, (), (0,), name="f"), "f: numerator is empty"),
        (lambda: rational(LINE, (0, 0), (0,), name="f"), "f: numerator has 0 twice"),
        (lambda: rational(LINE, (0,), (-1,), name="f"), "f: denominator has -1: allowed"),
        (lambda: rational(LINE, (0.5,), (0,), name="f"), "f: numerator has 0.5: allowed"),
        (lambda: rational(TOY, (0,), (0,), name="f"), "has 0: allowed are 2 whole numbers ≥ 0"),
        (lambda: rational(LINE, (0,), (0, 1), name="f", one=2), "f: one = 2: allowed are"),
        (
            lambda: rational(LINE, (0,), (0,), name="f", of=_named),
            r"test_rationals\.py:\d+: _named\(eta, other\): allowed arguments are the axes eta",
        ),
        (lambda: polynomial(LINE, 1, name="f", times=lambda eta: (eta, 1)), "expected is a scalar"),
        (lambda: polynomial(LINE, 1, name="f", of=lambda eta: [eta]), "has to return a scalar or"),
        (lambda: polynomial(LINE, 1, name="f", of=lambda *p: p[0]), "allowed arguments are"),
    ],
)
def test_what_is_no_form_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_names_of_coefficients_are_never_those_of_axes():
    reference = replace(LINE, axes=(replace(LINE.axes[0], name="a0", symbol="c1"),))
    form = rational(reference, (0, 1), (0, 1), name="f")
    assert form.coefficient_names == ["p0", "p1", "b1"]
    assert polynomial(reference, 1, name="f").coefficient_names == ["p0", "p1"]
