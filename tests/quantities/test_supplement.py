import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting.paper import (
    PAPER_FORMS,
    TERMS,
    QuadraticQ,
    RationalG,
    RationalPs,
    RationalR,
    direction_basis,
    terms,
)

RANDOM = np.random.default_rng(5)


def points(form, count: int) -> np.ndarray:
    """Give random points of a form's domain (count, axes), its corners among them."""
    lower = np.array([axis.lower for axis in form.axes])
    upper = np.array([axis.upper for axis in form.axes])
    unit = RANDOM.random((count, len(lower)))
    unit[:16] = np.round(unit[:16])
    return lower + (upper - lower) * unit


def coefficients(form) -> np.ndarray:
    # Small ones keep every denominator well away from zero.
    return RANDOM.uniform(0.1, 0.3, np.shape(form.coefficient_names()))


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
    RationalPs: ps_by_hand,
    RationalG: g_by_hand,
    QuadraticQ: q_by_hand,
    RationalR: r_by_hand,
}


@pytest.mark.parametrize("form", PAPER_FORMS.values(), ids=PAPER_FORMS)
def test_a_form_is_the_equation_that_it_says(form):
    c, at = coefficients(form), points(form, 200)
    values = jax.jit(jax.vmap(lambda x: form(jnp.asarray(c))(*x)))(at)
    np.testing.assert_allclose(values, [BY_HAND[form](c, *x) for x in at], rtol=1e-13)


@pytest.mark.parametrize("form", PAPER_FORMS.values(), ids=PAPER_FORMS)
def test_a_form_is_differentiable_on_its_closed_domain(form):
    c, at = jnp.asarray(coefficients(form)), points(form, 64)
    value_and_slopes = jax.jit(jax.vmap(jax.value_and_grad(lambda x: form(c)(*x))))
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


@pytest.mark.parametrize("form", PAPER_FORMS.values(), ids=PAPER_FORMS)
def test_a_form_restricts_the_axes_of_its_integral_to_finite_boxes(form):
    assert [axis.name for axis in form.axes] == [axis.name for axis in form.integral.axes]
    for axis, whole in zip(form.axes, form.integral.axes, strict=True):
        assert np.isfinite([axis.lower, axis.upper]).all()
        assert axis.contains(axis.lower)
        assert whole.contains(axis.lower)
        assert whole.contains(axis.upper)


@pytest.mark.parametrize("form", PAPER_FORMS.values(), ids=PAPER_FORMS)
def test_coefficient_names_are_distinct(form):
    names = np.ravel(form.coefficient_names())
    assert len(set(names)) == len(names) == {"ps": 162, "g": 4, "q": 2, "r": 17}[form.integral.name]


def test_forms_are_known_by_their_names():
    assert list(PAPER_FORMS) == ["rational-ps", "rational-g", "quadratic-q", "rational-r"]
    assert {form.integral.name for form in PAPER_FORMS.values()} == {"ps", "g", "q", "r"}
