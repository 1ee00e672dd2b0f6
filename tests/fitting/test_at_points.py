"""Forms at points: a wider form gives the values and derivatives of its special cases."""

from dataclasses import replace

import numpy as np
import pytest

from fitting.errors import form_values
from fitting.form import Form, Stage, Wider
from fitting.solvers.at_points import SlopesAt, ValuesAt
from quantities.fuzz import g_forms, q_forms
from tests.fitting.toys import AXES, TOY

POINTS = np.random.default_rng(1).uniform([0.0, 0.0], [1.0, 1.0], (40, 2))
WIDE = Form(
    name="wide",
    equation="c₀ + c₁x + c₂y + c₃xy",
    reference=TOY,
    axes=AXES,
    coefficient_names=["1", "x", "y", "xy"],
    stages=(Stage(lambda c, x, y: c[0] + c[1] * x + c[2] * y + c[3] * x * y),),
)
NARROW = Form(
    name="narrow",
    equation="c₀y + c₁x",
    reference=TOY,
    axes=AXES,
    coefficient_names=["y", "x"],
    stages=(Stage(lambda c, x, y: c[0] * y + c[1] * x),),
    wider=Wider(WIDE, (2, 1), (0.0,) * 4),
)


def test_a_special_case_has_the_values_and_derivatives_of_its_own_formula():
    c = np.array([3.0, -2.0])
    expected = 3 * POINTS[:, 1] - 2 * POINTS[:, 0]
    np.testing.assert_allclose(ValuesAt(NARROW, POINTS).values(c), expected, atol=1e-15)
    np.testing.assert_allclose(form_values(NARROW.fitted(c), POINTS), expected, atol=1e-15)
    rows = np.array([7, 3, 3])
    slopes = SlopesAt(NARROW, POINTS).values(c, rows)
    np.testing.assert_array_equal(slopes, POINTS[rows][:, [1, 0]])


def test_other_coefficients_and_other_rows_are_not_mistaken_for_the_last_ones():
    at, slopes = ValuesAt(WIDE, POINTS), SlopesAt(WIDE, POINTS)
    one, other = np.array([1.0, 0, 0, 0]), np.array([2.0, 0, 0, 0])
    assert set(at.values(one)) == {1.0}
    assert set(at.values(other)) == {2.0}
    assert set(at.rooms(other)) == {1.0}
    first, second = np.array([0, 1]), np.array([1, 2])
    np.testing.assert_array_equal(slopes.values(one, first)[:, 1], POINTS[first, 0])
    np.testing.assert_array_equal(slopes.values(one, second)[:, 1], POINTS[second, 0])
    assert not slopes.rooms(one, second).any()


def coefficients(form: Form) -> np.ndarray:
    random = np.random.default_rng(form.size)
    start = form.starts[0] if form.starts else np.ones(form.size)
    return start * random.uniform(0.5, 1.5, form.size) + 0.1 * random.normal(size=form.size)


SPECIAL = [*q_forms.candidates(), *g_forms.candidates()]
# Only proofs use these, which do not depend on the last digit.
QUOTIENTS = [
    q_forms._as_quotient(form.shape["structure"], *of, form.fitted(np.ones(form.size))).form
    for form in q_forms.candidates()
    if (of := (form.shape["terms"], form.shape["poles"]))[1]
]
FEW = [
    q_forms.pole_q(structure="slope", terms=0, poles=1),
    g_forms.decay_g(decay="power", rate="constant", factor="inverse"),
]


def require_the_same(form: Form, rtol: float = 0.0) -> None:
    """Compare a form with itself without a wider form."""
    alone = replace(form, wider=None)
    low, high = np.array([[axis.lower, axis.upper] for axis in form.axes]).T
    points = np.random.default_rng(3).uniform(low, high, (2048, len(low)))
    rows = np.arange(len(points))
    for sign in (1, -1):
        c = sign * coefficients(form)
        one, other = ValuesAt(form, points), ValuesAt(alone, points)
        slopes, other_slopes = SlopesAt(form, points), SlopesAt(alone, points)
        for found, expected in (
            (one.values(c), other.values(c)),
            (one.rooms(c), other.rooms(c)),
            (slopes.values(c, rows), other_slopes.values(c, rows)),
            (slopes.rooms(c, rows), other_slopes.rooms(c, rows)),
            (form_values(form.fitted(c), points), form_values(alone.fitted(c), points)),
        ):
            np.testing.assert_allclose(found, expected, rtol=rtol, atol=0)


@pytest.mark.parametrize("form", FEW, ids=lambda form: str(form.shape))
def test_forms_have_the_numbers_of_their_wider_ones_to_the_last_digit(form):
    require_the_same(form)


@pytest.mark.slow
@pytest.mark.parametrize("form", SPECIAL, ids=lambda form: str(form.shape))
def test_all_forms_have_the_numbers_of_their_wider_ones_to_the_last_digit(form):
    require_the_same(form)


@pytest.mark.slow
@pytest.mark.parametrize("form", QUOTIENTS, ids=lambda form: form.equation)
def test_quotients_for_proofs_have_the_numbers_of_their_wider_ones_up_to_rounding(form):
    require_the_same(form, rtol=1e-12)
