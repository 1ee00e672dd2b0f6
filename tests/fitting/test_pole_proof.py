import jax.numpy as jnp
import numpy as np
import pytest
from fitting.families.ps import two_root_ps
from fitting.paper import terms
from hypothesis import given, settings
from hypothesis import strategies as st

from coefficients.catalogue import form_of, load
from fitting import PAPER_FORMS, QuadraticQ, RationalG, RationalPs, RationalR
from fitting.form import Form, as_program
from fitting.proofs import pole_proof as certificate
from fitting.proofs.pole_proof import TIGHTNESS, certify_denominators
from programs.bounding import branch_and_bound as branch
from programs.program import evaluate, part, reached

PUBLISHED = ("ps", "g", "q", "r")


def sampled_denominators(form, count: int = 60) -> np.ndarray:
    """Evaluate the divisors of a form on a dense grid of its domain, the ends included."""
    program = as_program(form)
    program = part(program, certificate.operands(program, "div", 1))
    used = reached(program)
    lines = [
        np.linspace(axis.lower, axis.upper, count if k in used else 1)
        for k, axis in enumerate(form.axes)
    ]
    mesh = np.meshgrid(*lines, indexing="ij")
    return evaluate(program, np.stack([each.ravel() for each in mesh], axis=1))


def rational_r(beta: float, gamma: float, delta: float) -> RationalR:
    """Give R̃ with the denominator 1 + beta β + gamma γ + delta δ, and any numerator."""
    return RationalR(jnp.array([0.3, *np.linspace(-0.2, 0.2, 13), beta, gamma, delta]))


@pytest.mark.parametrize("quantity", PUBLISHED)
def test_published_forms_have_no_pole_and_a_bound_that_is_nearly_attained(quantity):
    form = form_of(load(f"published/{quantity}"))
    found = certify_denominators(form)
    assert found.holds
    if quantity == "q":
        assert found == certificate.Certificate(np.inf, 0)
    else:
        least = sampled_denominators(form).min()
        # The sampled least is above the true one, which is at least 0.9 times it.
        assert TIGHTNESS * least * 0.95 <= found.bound <= least


def test_the_denominators_are_those_of_the_equations():
    values = sampled_denominators(form_of(load("published/g")), 7)
    c = load("published/g").coefficients
    d, nu = np.meshgrid(np.linspace(0.001, 0.5, 7), np.linspace(0.001, 1, 7), indexing="ij")
    np.testing.assert_allclose(values[:, 0], np.ravel(d + c[2] * nu + c[3] * nu**3), rtol=1e-14)
    form = form_of(load("published/ps"))
    q = np.array(load("published/ps").coefficients)[:, 14:]
    alphas, thetas = (np.linspace(axis.lower, axis.upper, 5) for axis in form.axes[:2])
    expected = [1 + q @ terms(a, t) for a in alphas for t in thetas]
    np.testing.assert_allclose(
        np.sort(sampled_denominators(form, 5), axis=None), np.sort(expected, axis=None), rtol=1e-12
    )


# denominators of R̃ on α ∈ [0.15, 1], θf ∈ [0, π/2] that vanish somewhere, and their name
POLES = {
    "on the edge α = 0.15": rational_r(-1 / 0.85, 0, 0),
    "on the edge θf = 0": rational_r(0, -1, 0),
    "in a corner": rational_r(-0.5 / 0.85, -0.5, 0),
    # 1 − (γ + δ)/√2 touches zero at θf = π/4, which is a node of every odd grid …
    "touching zero at a node": rational_r(0, -(0.5**0.5), -(0.5**0.5)),
    # … and 1 − cos(θf − 0.7) does at 0.7, which is none; rounding may leave it just above.
    "touching zero between nodes": rational_r(0, -np.cos(0.7), -np.sin(0.7)),
    "crossing zero between nodes": rational_r(0, -1.00001 * np.cos(0.7), -1.00001 * np.sin(0.7)),
    "negative everywhere": rational_r(0, -2, -2),
    "G, along a curve": RationalG(jnp.array([-0.9, 0.4, 0.7, -1.3])),
    # d + c₂ν + c₃ν³ is least at ν = 0.1, d = 0.001: c₂/10 + c₃/1000 = −0.001001
    "G, in a narrow dip": RationalG(jnp.array([-0.9, 0.4, -0.015015, 0.5005])),
    "not a number": rational_r(np.nan, 0, 0),
}


@pytest.mark.parametrize("name", POLES)
def test_a_form_with_a_pole_is_not_certified(name):
    found = certify_denominators(POLES[name])
    assert not found.holds
    assert found.bound == -np.inf
    # None of these needs the limit on the number of boxes to be seen through.
    assert found.boxes < 20_000


def test_a_pole_between_the_nodes_of_the_finest_grid_is_not_seen_by_sampling():
    """What the certificate is for: every sampled denominator is positive, yet one vanishes."""
    for name in ("crossing zero between nodes", "G, in a narrow dip"):
        assert sampled_denominators(POLES[name], 65).min() > 0


def test_a_pole_in_the_first_or_the_last_row_of_ps_is_found():
    good = np.array(load("published/ps").coefficients)
    for row in (0, 5):
        bad = good.copy()
        # 1 + qᵀx with a double root at θf = 0.7, which no row's own sampling would show
        bad[row, 14:] = 0
        bad[row, [15, 16]] = [-1.0001 * np.cos(0.7), -1.0001 * np.sin(0.7)]
        assert not certify_denominators(RationalPs(jnp.asarray(bad))).holds


SLOPES = st.floats(0.01, 1.5) | st.floats(-1.5, -0.01)


@settings(max_examples=20, deadline=None)
@given(st.tuples(SLOPES, SLOPES, SLOPES))
def test_what_is_certified_is_positive_and_what_is_refused_is_not(slopes):
    form = rational_r(*slopes)
    found, least = certify_denominators(form), sampled_denominators(form, 101).min()
    if found.holds:
        assert 0.9 * TIGHTNESS * least <= found.bound <= least
    else:
        # The slope of the denominator is below 5, the samples are 0.016 apart.
        assert least <= 5 * 0.016


def test_a_nearly_vanishing_denominator_is_still_certified_tightly():
    # 1 − 0.9999 cos(θf − 0.7): least 1e-4, between the nodes
    found = certify_denominators(rational_r(0, -0.9999 * np.cos(0.7), -0.9999 * np.sin(0.7)))
    assert found.holds
    assert TIGHTNESS * 1e-4 <= found.bound <= 1e-4 * (1 + 1e-9)


def test_a_search_that_finds_no_end_is_given_up_as_not_proven(monkeypatch):
    monkeypatch.setattr(branch, "MAX_BOXES", 10)
    form = rational_r(0, -0.9999 * np.cos(0.7), -0.9999 * np.sin(0.7))
    assert not certify_denominators(form).holds


@pytest.mark.parametrize("form", PAPER_FORMS.values(), ids=PAPER_FORMS)
def test_the_program_of_a_form_is_the_form(form):
    random = np.random.default_rng(1)
    c = random.uniform(0.1, 0.3, np.shape(form.coefficient_names()))
    fitted = form(jnp.asarray(c))
    lower = np.array([axis.lower for axis in form.axes])
    upper = np.array([axis.upper for axis in form.axes])
    at = lower + (upper - lower) * random.random((20, len(lower)))
    values = evaluate(as_program(fitted), at)[:, 0]
    np.testing.assert_allclose(values, [float(fitted(*x)) for x in at], rtol=1e-13)


def test_a_form_without_divisions_needs_no_boxes():
    found = certify_denominators(QuadraticQ(jnp.array([-1.7, 1.2])))
    assert found.holds
    assert found.boxes == 0


def test_a_floor_hides_no_pole():
    """The floor of the denominator is reached: the value at this point is 112,650."""
    form = two_root_ps(terms=3, degree=0, least_alpha=0.15)(jnp.array([0.3, -3.0, 0.0]))
    assert abs(float(form(0.5, 0.3, 0.2, 0.0))) > 1e5
    assert not certify_denominators(form).holds


# Functions of d on [0, 0.5] that are infinite or no number somewhere, and ones that are not.
SINGULAR = {
    "a root of less than nothing": lambda d: jnp.sqrt((d - 0.3) ** 2 - 1e-9),
    "a logarithm of nothing": jnp.log,
    "a quotient within a root": lambda d: jnp.sqrt(1 / (d - 0.2) ** 2),
}
REGULAR = {
    "a root of nothing": jnp.sqrt,
    "a logarithm that is kept from zero": lambda d: d * jnp.log(jnp.maximum(d, 1e-30)),
    "a quotient that is kept from zero": lambda d: 1 / jnp.maximum(d - 0.2, 1e-3),
}


def form_of_d(call) -> type[Form]:
    class OfD(Form):
        """A function of d."""

        name = "of-d"
        equation = ""
        integral = QuadraticQ.integral
        axes = QuadraticQ.axes

        def __call__(self, d):
            return call(d)

        @classmethod
        def coefficient_names(cls):
            return []

    return OfD


@pytest.mark.parametrize("name", [*SINGULAR, *REGULAR])
def test_roots_and_logarithms_are_certified_too(name):
    form = form_of_d((SINGULAR | REGULAR)[name])(jnp.zeros(0))
    assert certify_denominators(form).holds == (name in REGULAR)


def test_what_may_have_a_pole_of_its_own_is_refused():
    with pytest.raises(ValueError, match=r"operation 'tan' .* has no meaning here"):
        certify_denominators(form_of_d(lambda d: jnp.tan(4 * d))(jnp.zeros(0)))
