"""Proof that a form has no pole: what is certified has none, and what has one is refused."""

import functools

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitting import FittedForm
from fitting.form import traced
from fitting.proofs import pole_proof
from fitting.proofs.pole_proof import certify_denominators, proof_axes
from integrals.reference import box_of
from programs import BranchAndBound, DenominatorBound, evaluate, subprogram
from programs.bounding.denominators import TIGHTNESS, operands
from quantities import problem
from quantities.fuzz.material import COS_PHI
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G, RATIONAL_PS, RATIONAL_R
from tests.fitting.toys import AXES, toy_form


def sampled_denominators(fitted: FittedForm, count: int = 60) -> np.ndarray:
    """Evaluate the divisors of a form of two axes on a dense grid, the ends included."""
    program = traced(fitted, fitted, fitted.axes)
    program = subprogram(program, operands(program, "div", 1))
    lines = [np.linspace(axis.lower, axis.upper, count) for axis in fitted.axes]
    mesh = np.meshgrid(*lines, indexing="ij")
    return evaluate(program, np.stack([each.ravel() for each in mesh], axis=1))


def rational_r(beta: float, gamma: float, delta: float) -> FittedForm:
    """Return R̃ with the denominator 1 + beta β + gamma γ + delta δ, and any numerator."""
    return RATIONAL_R.fitted(np.array([0.3, *np.linspace(-0.2, 0.2, 13), beta, gamma, delta]))


# Denominators of R̃ on α ∈ [0.15, 1], θf ∈ [0, π/2] that vanish somewhere, and their name.
POLES = {
    "on the edge α = 0.15": rational_r(-1 / 0.85, 0, 0),
    "on the edge θf = 0": rational_r(0, -1, 0),
    "in a corner": rational_r(-0.5 / 0.85, -0.5, 0),
    # 1 − (γ + δ)/√2 touches zero at θf = π/4, which is a node of every odd grid …
    "touching zero at a node": rational_r(0, -(0.5**0.5), -(0.5**0.5)),
    # … and 1 − cos(θf − 0.7) does at 0.7, which is none; rounding may leave it just above.
    "touching zero between nodes": rational_r(0, -np.cos(0.7), -np.sin(0.7)),
    "crossing zero between nodes": rational_r(0, -1.00001 * np.cos(0.7), -1.00001 * np.sin(0.7)),
    "G, along a curve": RATIONAL_G.fitted(np.array([-0.9, 0.4, 0.7, -1.3])),
    # d + c₂ν + c₃ν³ is least at ν = 0.1, d = 0.001: c₂/10 + c₃/1000 = −0.001001
    "G, in a narrow dip": RATIONAL_G.fitted(np.array([-0.9, 0.4, -0.015015, 0.5005])),
    "not a number": rational_r(np.nan, 0, 0),
}


@pytest.mark.parametrize("name", POLES)
def test_a_form_with_a_pole_is_not_certified(name):
    found = certify_denominators(POLES[name])
    assert not found.holds
    assert found.bound == -np.inf
    # None of these needs the limit on the number of boxes to be refused.
    assert found.boxes < 20_000


@pytest.mark.parametrize("name", ["crossing zero between nodes", "G, in a narrow dip"])
def test_samples_do_not_show_a_pole_between_the_nodes_of_the_finest_grid(name):
    """This is why there is a proof: every sampled denominator is positive, yet one vanishes."""
    assert sampled_denominators(POLES[name], 65).min() > 0


@pytest.mark.parametrize("row", [0, 5])
def test_a_pole_in_any_row_of_p_s_is_found(row):
    rows = np.zeros((6, 27))
    rows[:, :14] = np.linspace(-0.2, 0.2, 14)
    rows[:, 15] = 0.3
    assert certify_denominators(RATIONAL_PS.fitted(rows)).holds
    # 1 + qᵀx with a double root at θf = 0.7, which no row's own sampling would show
    rows[row, [15, 16]] = [-1.0001 * np.cos(0.7), -1.0001 * np.sin(0.7)]
    assert not certify_denominators(RATIONAL_PS.fitted(rows)).holds


SLOPES = st.floats(0.01, 1.5) | st.floats(-1.5, -0.01)


@settings(max_examples=10, deadline=None)
@given(st.tuples(SLOPES, SLOPES, SLOPES))
def test_certified_denominators_are_positive_and_refused_ones_nearly_vanish(slopes):
    fitted = rational_r(*slopes)
    found, values = certify_denominators(fitted), sampled_denominators(fitted, 101)
    # A divisor may be negative everywhere.
    least = max(values.min(), -values.max())
    if found.holds:
        assert 0.9 * TIGHTNESS * least <= found.bound <= least
    else:
        # The slope of the denominator is below 5, the samples are 0.016 apart.
        assert least <= 5 * 0.016


# 1 − 0.9999 cos(θf − 0.7): least 1e-4, between the nodes
NEARLY = rational_r(0, -0.9999 * np.cos(0.7), -0.9999 * np.sin(0.7))


def test_a_nearly_vanishing_denominator_is_still_bounded_tightly():
    found = certify_denominators(NEARLY)
    assert found.holds
    assert TIGHTNESS * 1e-4 <= found.bound <= 1e-4 * (1 + 1e-9)


def test_a_bound_that_is_enough_is_found_with_fewer_boxes():
    enough, tight = certify_denominators(NEARLY, 1e-6), certify_denominators(NEARLY)
    assert 1e-6 <= enough.bound <= tight.bound
    assert enough.boxes < tight.boxes


def test_a_search_that_reaches_its_limit_proves_nothing(monkeypatch):
    limited = functools.partial(BranchAndBound, max_boxes=10)
    monkeypatch.setattr(pole_proof, "BranchAndBound", limited)
    assert not certify_denominators(NEARLY).holds


def test_a_form_without_divisions_needs_no_boxes():
    found = certify_denominators(QUADRATIC_Q.fitted(np.array([-1.7, 1.2])))
    assert found == DenominatorBound(np.inf, 0)
    assert found.holds


TWO_ROOT = problem("ps").find_form("two-root-ps", {"terms": 3, "degree": 0, "least_alpha": 0.15})


def test_a_floor_of_a_denominator_hides_no_pole():
    """The floor of the denominator is reached: the value at this point is 112,650."""
    fitted = TWO_ROOT.fitted(np.array([0.3, -3.0, 0.0]))
    assert abs(float(fitted(0.5, 0.3, 0.2, 0.0))) > 1e5
    assert not certify_denominators(fitted).holds


def test_proofs_may_take_other_axes_than_the_form():
    assert proof_axes(TWO_ROOT) == (*TWO_ROOT.axes[:3], COS_PHI)
    assert proof_axes(RATIONAL_R) == RATIONAL_R.axes
    assert box_of(proof_axes(TWO_ROOT))[3].tolist() == [-1, 1]


# Functions of y on [−1, 2] that are infinite or no number somewhere, and ones that are not.
SINGULAR = {
    "the root of a negative number": lambda y: jnp.sqrt((y - 0.3) ** 2 - 1e-9),
    "the logarithm of zero": lambda y: jnp.log(y + 1),
    "a quotient within a root": lambda y: jnp.sqrt(1 / (y - 0.2) ** 2),
}
REGULAR = {
    "the root of zero": lambda y: jnp.sqrt(y + 1),
    "a logarithm that is kept from zero": lambda y: y * jnp.log(jnp.maximum(y + 1, 1e-30)),
    "a quotient that is kept from zero": lambda y: 1 / jnp.maximum(y - 0.2, 1e-3),
}


@pytest.mark.parametrize("name", [*SINGULAR, *REGULAR])
def test_roots_and_logarithms_are_certified_too(name):
    call = (SINGULAR | REGULAR)[name]
    form = toy_form(lambda c, y: call(y), [], axes=AXES[1:])
    assert certify_denominators(form.fitted(np.zeros(0))).holds == (name in REGULAR)


def test_an_operation_with_poles_of_its_own_is_refused_where_it_has_one():
    for factor, holds in ((0.7, True), (4, False)):
        form = toy_form(lambda c, y, factor=factor: jnp.tan(factor * y), [], axes=AXES[1:])
        assert certify_denominators(form.fitted(np.zeros(0))).holds == holds
