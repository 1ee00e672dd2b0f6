"""Fits under constraints that are linear in the coefficients."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting.fit import fit
from fitting.form import Proofs, plain_form
from fitting.goal import Goal
from fitting.solvers.within_margins import WithinMargins
from integrals import Axis, Sampling, closed_form, make_reference

REFERENCE = make_reference(
    closed_form(lambda x: (x - 0.5) ** 2),
    name="bowl",
    axes=[Axis("x", 0.0, 1.0)],
    sampling=Sampling(6, 7, 7),
)


def parabola(x, a, b, c):
    """a + b x + c x²"""
    return a + x * (b + x * c)


def form_with(margins):
    plain = plain_form(parabola, REFERENCE)
    solver = WithinMargins(room=0.0, first=1, nodes=9, coarse=1)
    return replace(plain, proofs=Proofs(margins=margins), scattered_solver=solver)


RISING = form_with(lambda c, x: (c[1] + 2 * c[2] * x,))
LARGEST = Goal(norm="linf")


def test_the_best_monotone_function_is_found():
    """(x − ½)² falls by ¼, so the errors of a rising function are at least half of that."""
    found = RISING.scattered_solver.fit(RISING, LARGEST, "uniform", None, lambda _: None)
    assert found.converged
    values = parabola(found.sample.points[:, 0], *found.coefficients)
    assert np.abs(values - found.sample.exact).max() == pytest.approx(0.125, abs=2e-4)
    assert found.coefficients[1] >= -1e-9
    # Without the constraint the form is exact.
    free = form_with(lambda c, x: (jnp.ones(()) + 0 * c[0],))
    found = free.scattered_solver.fit(free, LARGEST, "uniform", None, lambda _: None)
    np.testing.assert_allclose(found.coefficients, [0.25, -1.0, 1.0], atol=1e-6)


def test_coefficients_are_rounded_within_the_constraints():
    goal = Goal(norm="linf", rounding="float16")
    found = RISING.scattered_solver.fit(RISING, goal, "uniform", None, lambda _: None)
    np.testing.assert_array_equal(found.coefficients, found.coefficients.astype(np.float16))
    assert found.coefficients[1] >= -1e-9
    assert found.coefficients[1] + 2 * found.coefficients[2] >= -1e-9


@pytest.mark.parametrize("goal", [Goal(), Goal(norm="linf", side="below")])
def test_other_goals_are_refused(goal):
    with pytest.raises(ValueError, match="allowed is the goal norm = 'linf', side = 'both'"):
        fit(RISING, goal)


def test_margins_that_are_not_affine_are_refused():
    bent = form_with(lambda c, x: (c[1] * c[2] + x,))
    with pytest.raises(ValueError, match="not affine in the coefficients"):
        fit(bent, LARGEST)


def test_constraints_that_nothing_obeys_are_refused():
    impossible = form_with(lambda c, x: (c[1] - 1.0, -c[1]))
    with pytest.raises(ValueError, match="no coefficients obey the constraints"):
        fit(impossible, LARGEST)
