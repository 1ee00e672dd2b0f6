"""What is linear in a form's coefficients, and what must stay positive, found in its program."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitting.linearity import derived_positive, linear_parts, positive_of, program_of
from fitting.points.grids import sobol_points
from programs import evaluate
from quantities import problem
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G, RATIONAL_PS, RATIONAL_R, terms
from tests.fitting.toys import AXES, PLANE, QUOTIENT, toy_form

MONOMIAL_R = problem("r").find_form(
    "monomial-r",
    {
        "variable": "1-alpha^2",
        "numerator": [[0, 0], [0, 1], [2, 1]],
        "denominator": [[1, 0], [1, 1]],
        "least_alpha": 0.15,
    },
)


def parts_of_q(density):
    """Return a₀, a, b₀ and b of 1 + c₀d + c₁d², by hand."""
    return 1.0, [density, density**2], 1.0, [0.0, 0.0]


def parts_of_g(density, nu):
    """Return a₀, a, b₀ and b of d (1 + c₀ν + c₁ν²)/(d + c₂ν + c₃ν³), by hand."""
    above = [density * nu, density * nu**2, 0.0, 0.0]
    return density, above, density, [0.0, 0.0, nu, nu**3]


def parts_of_r(alpha, theta_f):
    """Return a₀, a, b₀ and b of ½ + β (t + pᵀx)/(1 + qᵀy), by hand: over one denominator."""
    x, beta = np.asarray(terms(alpha, theta_f)), 1 - alpha
    above = [beta, *(beta * x), *(0.5 * x[:3])]
    return 0.5, above, 1.0, [*[0.0] * 14, *x[:3]]


def parts_of_monomial_r(alpha, theta_f):
    """Return a₀, a, b₀ and b of ½ + z N/D with the monomials of MONOMIAL_R, by hand."""
    z, y = 1 - alpha**2, np.cos(theta_f) ** 2
    below = [z, z * y]
    return 0.5, [z, z * y, z * z**2 * y, *(0.5 * each for each in below)], 1.0, [0, 0, 0, *below]


BY_HAND = {
    "quadratic-q": (QUADRATIC_Q, parts_of_q),
    "rational-g": (RATIONAL_G, parts_of_g),
    "rational-r": (RATIONAL_R, parts_of_r),
    "monomial-r": (MONOMIAL_R, parts_of_monomial_r),
}


def quotient_at(parts, c: np.ndarray) -> np.ndarray:
    return (parts.a0 + parts.a @ c) / (parts.b0 + parts.b @ c)


def values_at(form, c: np.ndarray, points: np.ndarray) -> np.ndarray:
    return np.asarray(jax.vmap(lambda x: form(jnp.asarray(c), *x))(points))


@pytest.mark.parametrize("name", BY_HAND)
def test_the_parts_are_those_by_hand(name):
    form, by_hand = BY_HAND[name]
    points = sobol_points(form.axes, 5, seed=6)
    parts = linear_parts(form, points)
    assert parts is not None
    expected = [np.array(each) for each in zip(*(by_hand(*x) for x in points), strict=True)]
    for found, wanted in zip((parts.a0, parts.a, parts.b0, parts.b), expected, strict=True):
        assert found.shape == wanted.shape
        np.testing.assert_allclose(found, wanted, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("name", BY_HAND)
def test_the_parts_give_the_values_of_the_form(name):
    form, _ = BY_HAND[name]
    points, random = sobol_points(form.axes, 6, seed=7), np.random.default_rng(4)
    parts = linear_parts(form, points)
    assert parts is not None
    for _ in range(5):
        c = random.uniform(0.1, 0.4, form.size)
        np.testing.assert_allclose(quotient_at(parts, c), values_at(form, c, points), rtol=1e-12)


@pytest.mark.parametrize("variable", ["1-alpha", "1-alpha^2", "(1-alpha)/(1+alpha)"])
def test_forms_of_r_are_quotients_in_every_variable(variable):
    form = problem("r").find_form("monomial-r", {**MONOMIAL_R.shape, "variable": variable})
    c, points = np.array([0.3, -0.2, 0.1, 0.4, 0.2]), np.array([[0.2, 0.1], [0.6, 1.2], [1, 0.4]])
    parts = linear_parts(form, points)
    assert parts is not None
    np.testing.assert_allclose(quotient_at(parts, c), values_at(form, c, points), rtol=1e-14)


@pytest.mark.parametrize("name", ["free", "one", "slope", "log"])
def test_forms_of_q_without_poles_are_linear(name):
    form = problem("q").find_form("pole-q", {"structure": name, "terms": 3, "poles": 0})
    points = sobol_points(form.axes, 4, seed=1)
    parts = linear_parts(form, points)
    assert parts is not None and parts.is_linear
    c = np.array([0.4, -0.3, 0.2])
    np.testing.assert_allclose(quotient_at(parts, c), values_at(form, c, points), rtol=1e-13)


def test_a_form_with_coefficients_below_is_not_called_linear():
    points = sobol_points(RATIONAL_G.axes, 3, seed=1)
    assert not linear_parts(RATIONAL_G, points).is_linear
    assert linear_parts(QUADRATIC_Q, points[:, :1]).is_linear


NO_QUOTIENTS = {
    "roots of surfaces": problem("ps").find_form(
        "two-root-ps", {"terms": 3, "degree": 1, "least_alpha": 0.15}
    ),
    "a coefficient in an exponent": problem("g").find_form(
        "decay-g", {"decay": "exponential", "rate": "scaled", "factor": "affine"}
    ),
    "a pole whose place is a coefficient": problem("q").find_form(
        "pole-q", {"structure": "free", "terms": 1, "poles": 1}
    ),
    "two poles": problem("q").find_form("pole-q", {"structure": "one", "terms": 1, "poles": 2}),
    "six quotients in a sum": RATIONAL_PS,
    "a product of coefficients": toy_form(lambda c, x, y: c[0] * c[1] * x + y, ["a", "b"]),
    "a square": toy_form(lambda c, x, y: c[0] ** 2 * x + y, ["a"]),
    "a selection by a coefficient": toy_form(
        lambda c, x, y: jnp.where(c[0] > 0, c[0] * x, y), ["a"]
    ),
    "a quotient in a denominator": toy_form(
        lambda c, x, y: 1 / (2 + y / (1 + c[0] * x)) + c[1], ["a", "b"]
    ),
}


@pytest.mark.parametrize("name", NO_QUOTIENTS)
def test_other_forms_have_no_linear_parts(name):
    form = NO_QUOTIENTS[name]
    assert linear_parts(form, sobol_points(form.axes, 3, seed=1)) is None


# Random expressions in x and y, and ones that are linear in three coefficients besides.
NUMBERS = st.floats(0.125, 2, width=16)
FREE = st.recursive(
    st.one_of(st.sampled_from(["x", "y"]), NUMBERS),
    lambda inner: st.tuples(st.sampled_from(["+", "*", "cos", "exp"]), inner, inner),
    max_leaves=4,
)
LINEAR = st.recursive(
    st.one_of(st.sampled_from([0, 1, 2]), FREE),
    lambda inner: st.one_of(
        st.tuples(st.sampled_from(["+", "-"]), inner, inner),
        st.tuples(st.just("times"), FREE, inner),
        st.tuples(st.just("over"), inner, FREE),
        st.tuples(st.just("minus"), inner),
    ),
    max_leaves=6,
)


def compute(tree, c, x, y):
    """Evaluate a random expression; divisors are made positive."""
    match tree:
        case "x":
            return x
        case "y":
            return y
        case int():
            return c[tree]
        case float():
            return tree
        case ("minus", one):
            return -compute(one, c, x, y)
    kind, one, other = tree[0], compute(tree[1], c, x, y), compute(tree[2], c, x, y)
    operations = {
        "+": lambda: one + other,
        "-": lambda: one - other,
        "*": lambda: one * other,
        "times": lambda: one * other,
        "over": lambda: one / (2 + jnp.abs(jnp.asarray(other))),
        "cos": lambda: jnp.cos(one) * other,
        "exp": lambda: jnp.exp(-(one**2)) + other,
    }
    return operations[kind]()


@settings(max_examples=30, deadline=None)
@given(above=LINEAR, below=LINEAR, free=FREE, around=st.sampled_from(["alone", "sum", "product"]))
@pytest.mark.slow
def test_every_quotient_of_linear_functions_is_found(above, below, free, around):
    """(N + …)/(D + …), with a function of the axes added or multiplied, has the form's values."""

    def value(c, x, y):
        quotient = compute(above, c, x, y) / (8 + compute(below, c, x, y))
        outside = compute(free, c, x, y)
        if around == "sum":
            return jnp.asarray(outside + quotient)
        return jnp.asarray(quotient * outside if around == "product" else quotient)

    form = toy_form(value, ["a", "b", "c"])
    points = sobol_points(AXES, 4, seed=8)
    parts = linear_parts(form, points)
    assert parts is not None
    for c in np.random.default_rng(2).uniform(-1, 1, (3, 3)):
        expected = values_at(form, c, points)
        # Where terms cancel, in the denominator too, rounding is relative to the terms.
        below_size = np.abs(parts.b0) + np.abs(parts.b) @ np.abs(c)
        cancelled = below_size / np.abs(parts.b0 + parts.b @ c)
        size = (np.abs(parts.a0) + np.abs(parts.a) @ np.abs(c)) / below_size
        error = np.abs(quotient_at(parts, c) - expected)
        assert (error <= 1e-13 * (np.abs(expected) + size * cancelled) * cancelled + 1e-300).all()


@settings(max_examples=15, deadline=None)
@given(tree=LINEAR)
def test_every_linear_function_is_found_to_be_linear(tree):
    form = toy_form(lambda c, x, y: jnp.asarray(compute(tree, c, x, y) + 0.0 * x), ["a", "b", "c"])
    parts = linear_parts(form, sobol_points(AXES, 3, seed=8))
    assert parts is not None and parts.is_linear


# What must stay positive


def least_denominator_of_g(c, density, nu):
    return density + c[2] * nu + c[3] * nu**3


def denominator_of_monomial_r(c, alpha, theta_f):
    z, y = 1 - alpha**2, np.cos(theta_f) ** 2
    return 1 + c[3] * z + c[4] * z * y


@pytest.mark.parametrize(
    ("form", "expected"),
    [
        (RATIONAL_R, RATIONAL_R.proofs.positive),
        (RATIONAL_R, lambda c, *x: 1 + c[14:] @ np.asarray(terms(*x))[:3]),
        (RATIONAL_G, least_denominator_of_g),
        (MONOMIAL_R, denominator_of_monomial_r),
        (QUOTIENT, lambda c, x, y: 1 + c[3] * x + c[4] * y * y),
    ],
    ids=["rational-r, its own", "rational-r", "rational-g", "monomial-r", "toy"],
)
def test_the_denominator_must_stay_positive(form, expected):
    positive, random = derived_positive(form), np.random.default_rng(3)
    for point in sobol_points(form.axes, 4, seed=9):
        # With coefficients of both signs the denominator is negative at some points.
        c = random.uniform(-2, 2, form.size)
        assert float(positive(c, *point)) == pytest.approx(float(expected(c, *point)), rel=1e-12)


def test_of_several_divisors_the_least_must_stay_positive():
    form = toy_form(
        lambda c, x, y: 1 / (2 + c[0] * x) + y / (3 - c[1] * y) + x / (1 + x), ["a", "b"]
    )
    for c in ([1.0, 1.0], [-3.0, 0.5], [0.0, 2.0]):
        expected = min(2 + c[0] * 0.5, 3 - c[1] * 1.5)
        assert float(derived_positive(form)(np.array(c), 0.5, 1.5)) == pytest.approx(expected)


def test_radicands_and_arguments_of_logarithms_must_stay_positive():
    root = toy_form(lambda c, x, y: jnp.sqrt(c[0] + x), ["a"])
    logarithm = toy_form(lambda c, x, y: jnp.log(c[0] * x), ["a"])
    over_root = toy_form(lambda c, x, y: x / jnp.sqrt(c[0] + y), ["a"])
    c = np.array([0.25])
    assert float(derived_positive(root)(c, 0.5, 0.0)) == 0.75
    assert float(derived_positive(logarithm)(c, 0.5, 0.0)) == 0.125
    # A divisor that is a root counts as its radicand, which may be negative.
    assert float(derived_positive(over_root)(c, 0.5, -1.0)) == -0.75


def test_what_holds_no_coefficient_need_not_stay_positive():
    form = toy_form(lambda c, x, y: c[0] / (x - 5) + jnp.sqrt(2 + y) + jnp.log(3 + y), ["a"])
    assert float(derived_positive(form)(np.array([1.0]), 0.5, 0.5)) == 1
    assert float(derived_positive(PLANE)(np.ones(3), 0.5, 0.5)) == 1


def test_what_must_stay_positive_has_derivatives():
    positive, c = derived_positive(QUOTIENT), jnp.array([0.3, 0.2, 0.1, -0.4, 0.2])
    slopes = jax.grad(positive)(c, 0.5, 1.5)
    np.testing.assert_allclose(slopes, [0, 0, 0, 0.5, 2.25], rtol=1e-15)


def test_a_fit_takes_the_forms_own_function_where_there_is_one():
    assert positive_of(RATIONAL_R) is RATIONAL_R.proofs.positive
    assert positive_of(QUOTIENT) is derived_positive(QUOTIENT)
    # A fit of Eq. (3) steps where it will: only the certificate excludes poles.
    assert float(positive_of(RATIONAL_G)(np.full(4, -1.0), 0.1, 1.0)) == 1


# The program


@pytest.mark.parametrize("form", [PLANE, QUOTIENT, RATIONAL_G, RATIONAL_R, RATIONAL_PS])
def test_the_program_takes_coefficients_and_then_the_axes(form):
    program, random = program_of(form), np.random.default_rng(5)
    assert len(program.inputs) == form.size + len(form.axes)
    assert program.inputs[form.size :] == tuple(axis.name for axis in form.axes)
    points = sobol_points(form.axes, 3, seed=2)
    c = random.uniform(0.1, 0.3, form.size)
    rows = np.concatenate([np.broadcast_to(c, (len(points), form.size)), points], axis=1)
    expected = values_at(form, c.reshape(form.coefficient_shape), points)
    np.testing.assert_allclose(evaluate(program, rows)[:, 0], expected, rtol=1e-12)


def test_a_form_without_coefficients_has_a_program_of_its_axes():
    form = toy_form(lambda c, x, y: jnp.asarray(x + y), [])
    assert program_of(form).inputs == ("x", "y")
    parts = linear_parts(form, np.array([[0.25, 0.5]]))
    assert parts is not None and parts.is_linear
    np.testing.assert_array_equal(parts.a0 / parts.b0, [0.75])
