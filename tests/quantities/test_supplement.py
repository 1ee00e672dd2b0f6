"""The forms in print, Eq. (1) to (5), against the same equations in plain NumPy."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting.form import traced
from integrals.reference import box_of
from programs import evaluate
from quantities.fuzz.supplement import (
    PS_ROWS,
    QUADRATIC_Q,
    RATIONAL_G,
    RATIONAL_PS,
    RATIONAL_R,
    TERMS,
    direction_basis,
    terms,
)

FORMS = {form.name: form for form in (RATIONAL_PS, RATIONAL_G, QUADRATIC_Q, RATIONAL_R)}
RANDOM = np.random.default_rng(5)


def points(form, count: int) -> np.ndarray:
    """Return random points of a form's domain (count, axes), its corners among them."""
    lower, upper = box_of(form.axes).T
    unit = RANDOM.random((count, len(lower)))
    unit[:16] = np.round(unit[:16])
    return lower + (upper - lower) * unit


def coefficients(form) -> np.ndarray:
    # Small ones keep every denominator far from zero.
    return RANDOM.uniform(0.1, 0.3, form.coefficient_shape)


@pytest.mark.parametrize("position", range(13))
def test_each_term_is_the_monomial_that_it_is_called(position):
    alpha, theta_f = 0.35, 0.7
    power = {"²": 2, "³": 3}
    value = 1.0
    for letter, following in zip(TERMS[position], TERMS[position][1:] + " ", strict=True):
        if letter in "βγδ":
            base = {"β": 1 - alpha, "γ": np.cos(theta_f), "δ": np.sin(theta_f)}[letter]
            value *= base ** power.get(following, 1)
    assert terms(alpha, theta_f)[position] == pytest.approx(value, rel=1e-15)


def test_the_basis_of_directions_is_in_the_order_of_eq_1():
    n, t = 0.3, -0.8
    np.testing.assert_allclose(
        direction_basis(n, t), [1, n, t, n**2, n * t, t**2], rtol=1e-15, atol=0
    )


def by_eq_2(c, alpha, theta_f):
    b, g, d = 1 - alpha, np.cos(theta_f), np.sin(theta_f)
    x = [b, g, d, b**2, g**2, b * g, b * d, b**3, g**3, d**3, b**2 * g, b**2 * d, b * g**2]
    material = [row[0] + row[1:14] @ x for row in c] / (1 + c[:, 14:] @ x)
    return np.array([0.5, 0, 0, 0, 0, 0]) + b * material


def ps_by_hand(c, alpha, theta_f, theta_u, phi):
    n = np.cos(theta_u)
    t = np.sin(theta_u) * np.cos(phi) * np.sin(theta_f) + n * np.cos(theta_f)
    return by_eq_2(c, alpha, theta_f) @ [1, n, t, n**2, n * t, t**2]


def g_by_hand(c, d, nu):
    return d * (1 + c[0] * nu + c[1] * nu**2) / (d + c[2] * nu + c[3] * nu**3)


def q_by_hand(c, d):
    return 1 + c[0] * d + c[1] * d**2


def r_by_hand(c, alpha, theta_f):
    b, g, d = 1 - alpha, np.cos(theta_f), np.sin(theta_f)
    x = [b, g, d, b**2, g**2, b * g, b * d, b**3, g**3, d**3, b**2 * g, b**2 * d, b * g**2]
    return 0.5 + b * (c[0] + c[1:14] @ x) / (1 + c[14:] @ [b, g, d])


BY_HAND = {
    "rational-ps": ps_by_hand,
    "rational-g": g_by_hand,
    "quadratic-q": q_by_hand,
    "rational-r": r_by_hand,
}


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_the_equation_that_it_says(name):
    form = FORMS[name]
    c, at = coefficients(form), points(form, 200)
    values = jax.jit(jax.vmap(lambda x: form(jnp.asarray(c), *x)))(at)
    np.testing.assert_allclose(values, [BY_HAND[name](c, *x) for x in at], rtol=1e-13)


def test_the_first_stage_of_p_s_is_eq_2():
    c = coefficients(RATIONAL_PS)
    for alpha, theta_f in points(RATIONAL_PS, 30)[:, :2]:
        expected = by_eq_2(c, alpha, theta_f)
        np.testing.assert_allclose(RATIONAL_PS.first(c, alpha, theta_f), expected, rtol=1e-13)
        np.testing.assert_allclose(PS_ROWS(c, alpha, theta_f), expected, rtol=1e-13)


@pytest.mark.parametrize("name", FORMS)
def test_the_traced_program_of_a_form_is_the_form(name):
    form = FORMS[name]
    fitted, at = form.fitted(coefficients(form)), points(form, 20)
    values = evaluate(traced(fitted, fitted, fitted.axes), at)[:, 0]
    np.testing.assert_allclose(values, [float(fitted(*x)) for x in at], rtol=1e-13)


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_differentiable_on_its_closed_domain(name):
    form = FORMS[name]
    c, at = jnp.asarray(coefficients(form)), points(form, 64)
    value_and_slopes = jax.jit(jax.vmap(jax.value_and_grad(lambda x: form(c, *x))))
    _, slopes = value_and_slopes(at)
    assert np.isfinite(slopes).all()
    step = 1e-6
    for k, axis in enumerate(form.axes):
        move = step * np.eye(len(form.axes))[k]
        difference = (value_and_slopes(at + move)[0] - value_and_slopes(at - move)[0]) / (2 * step)
        inner = (at[:, k] - step > axis.lower) & (at[:, k] + step < axis.upper)
        # Rounding 1e-16/step, relative to slopes that are largest where G starts at ν = 0.001.
        tolerance = 1e-6 * np.abs(slopes).max()
        np.testing.assert_allclose(difference[inner], slopes[inner, k], rtol=1e-6, atol=tolerance)


@pytest.mark.parametrize("name", FORMS)
def test_a_form_restricts_the_axes_of_its_quantity_to_finite_boxes(name):
    form = FORMS[name]
    assert [axis.name for axis in form.axes] == [axis.name for axis in form.reference.axes]
    for axis, whole in zip(form.axes, form.reference.axes, strict=True):
        assert np.isfinite([axis.lower, axis.upper]).all()
        assert axis.contains(axis.lower)
        assert whole.contains(axis.lower)
        assert whole.contains(axis.upper)


@pytest.mark.parametrize(
    ("form", "size"),
    [(RATIONAL_PS, 162), (RATIONAL_G, 4), (QUADRATIC_Q, 2), (RATIONAL_R, 17)],
    ids=FORMS,
)
def test_coefficient_names_are_distinct(form, size):
    names = np.ravel(form.coefficient_names)
    assert len(set(names)) == len(names) == form.size == size


@pytest.mark.parametrize("name", FORMS)
def test_forms_in_print_have_no_margins_that_would_prove_their_range(name):
    assert FORMS[name].proofs.margins is None
