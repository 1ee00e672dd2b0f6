"""Whether a small change of coefficients would lower a form's largest error."""

import functools
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Goal, form_values
from fitting.fit import Fit, fit
from fitting.proofs.local_optimality import local_optimality
from fitting.solvers.minimax import Minimax
from fitting.solvers.residuals import residuals
from quantities.fuzz.supplement import QUADRATIC_Q
from tests.fitting.toys import TOY, toy_form

# A form that is no quotient of linear functions
STEEP = toy_form(
    lambda c, x, y: jnp.exp(-c[0] * x) * (c[1] + c[2] * y),
    ["rate", "1", "y"],
    starts=(np.array([1.0, 2.0, 0.5]),),
)


@functools.cache
def steep() -> Fit:
    return fit(STEEP, Goal("linf"))


NODES = np.linspace(0, 0.5, 501)[:, None]
EXACT = np.exp(-2 * NODES[:, 0])


def test_a_fit_states_that_it_is_a_local_optimum():
    found = steep()
    assert found.least_error is None
    stated = found.local_optimality
    assert stated is not None
    assert stated.decrease < 1e-4
    # Three coefficients: up to four extrema hold the largest error down.
    assert 2 <= stated.extrema <= 4


# The largest errors are at x = 0, where the rate has no effect: only the others are determined.
@pytest.mark.parametrize("index", [1, 2])
def test_changed_coefficients_are_no_local_optimum(index):
    found = steep()
    points, exact = found.grid.points, found.grid.exact
    for factor in (0.99, 1.01):
        changed = found.fitted.constants.copy()
        changed[index] *= factor
        worse = local_optimality(STEEP.fitted(changed), points, exact)
        assert worse is not None and worse.decrease > 0.02


def test_least_squares_are_no_local_optimum_and_state_nothing():
    found = steep()
    squares = fit(STEEP, Goal())
    assert squares.local_optimality is None
    measured = local_optimality(squares.fitted, found.grid.points, found.grid.exact)
    assert measured is not None and measured.decrease > 0.1


def test_the_stated_decrease_is_not_exceeded_by_any_small_step():
    """Of a form that is linear in its coefficients, the tangent is the form itself."""
    z = np.array([-1.79, 1.24])
    stated = local_optimality(QUADRATIC_Q.fitted(z), NODES, EXACT)
    assert stated is not None
    every = np.full(2, True)
    problem = residuals(QUADRATIC_Q, NODES, EXACT, np.ones(501), every, z)
    size = np.abs(problem.values(z)).max()
    random, most = np.random.default_rng(5), 0.0
    for step in random.normal(size=(4000, 2)) * np.array([0.02, 0.05]):
        moved = problem.values(z + step)
        if np.sqrt(np.mean((moved - problem.values(z)) ** 2)) <= size:
            most = max(most, 1 - np.abs(moved).max() / size)
    assert 0.1 < most <= stated.decrease
    # At the best coefficients there is nothing to gain.
    best = Minimax()(problem, z)
    assert local_optimality(QUADRATIC_Q.fitted(best), NODES, EXACT).decrease < 1e-6


def test_bounds_on_values_hold_a_bounded_fit_down():
    """The error could be lowered, but values would be above one."""
    exact = np.full(501, 0.995)
    form = replace(QUADRATIC_Q, stages=QUADRATIC_Q.stages)
    z = np.zeros(2)
    # 1 + c₀d + c₁d² is 1 everywhere, and may not rise.
    free = local_optimality(form.fitted(z), NODES, exact)
    bounded = local_optimality(form.fitted(z), NODES, exact, bounded=True)
    assert free is not None and bounded is not None
    assert bounded.decrease <= free.decrease + 1e-9


def test_what_has_no_coefficients_or_errors_has_no_such_number():
    points = np.array([[0.1, 0.2], [0.3, 0.4]])
    none = toy_form(lambda c, x, y: x + y, [])
    assert local_optimality(none.fitted(np.zeros(0)), points, np.ones(2)) is None
    exact = toy_form(lambda c, x, y: jnp.exp(-x) * (c[0] + jnp.sin(y)), ["two"])
    fitted = exact.fitted(np.array([2.0]))
    values = form_values(fitted, points)
    assert np.abs(values - TOY.values(points)).max() < 1e-15
    assert local_optimality(fitted, points, values) is None


def test_fewer_points_show_less():
    found = steep()
    few = local_optimality(found.fitted, found.grid.points[:5], found.grid.exact[:5])
    assert few is not None and few.decrease > 0.1 > found.local_optimality.decrease
