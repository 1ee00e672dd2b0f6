"""Second opinions by jaxopt."""

import functools
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Goal
from fitting.fit import fit
from fitting.goal import LEAST_SQUARES
from fitting.second_opinion import second_opinion
from tests.fitting.toys import QUOTIENT, toy_form


@functools.cache
def made(goal: Goal = LEAST_SQUARES, nodes: int | None = None):
    return fit(QUOTIENT, goal, nodes)


@pytest.mark.parametrize("goal", [pytest.param(Goal(), marks=pytest.mark.slow), Goal("linf")])
def test_jaxopt_ends_in_the_same_place(goal):
    found = made(goal)
    opinion = second_opinion(QUOTIENT, goal, found)
    assert opinion.agreed and not opinion.better
    # jaxopt ends where the sum of squares changes no more in float64's eight digits.
    assert opinion.other_error == pytest.approx(opinion.error, rel=1e-6)
    assert opinion.values < 0.01 * opinion.error
    assert opinion.coefficients < 0.05
    assert opinion.tried > 4


@pytest.mark.slow
def test_a_fit_on_a_grid_has_a_second_opinion_too():
    found = made(nodes=9)
    opinion = second_opinion(QUOTIENT, Goal(), found)
    assert opinion.error == pytest.approx(found.on_grid.rms, rel=1e-9)
    assert opinion.agreed


@pytest.mark.slow
def test_a_fit_that_is_not_the_best_is_told():
    found = made()
    moved = found.fitted.constants * np.array([1.05, 1, 1, 1, 1])
    worse = replace(found, fitted=QUOTIENT.fitted(moved))
    opinion = second_opinion(QUOTIENT, Goal(), worse)
    assert opinion.better and not opinion.agreed
    assert opinion.other_error == pytest.approx(found.on_grid.rms, rel=1e-6)


@pytest.mark.slow
def test_a_local_minimum_is_told():
    """The frequency of a wave has a minimum of the sum of squares near every multiple."""
    form = toy_form(
        lambda c, x, y: c[0] + c[1] * x + 0.05 * jnp.sin(c[2] * y),
        ["1", "x", "frequency"],
        starts=(np.array([2.0, -1.0, 14.0]),),
    )
    found = fit(form)
    assert found.converged
    assert second_opinion(form, Goal(), found).better


def test_what_has_no_second_opinion_is_refused():
    found = made()
    with pytest.raises(ValueError, match="rounding = 'float16': a second opinion needs 'none'"):
        second_opinion(QUOTIENT, Goal(rounding="float16"), found)
    fixed = toy_form(lambda c, x, y: x + y, [], name="fixed")
    with pytest.raises(ValueError, match="fixed has no coefficients"):
        second_opinion(fixed, Goal(), found)
    with pytest.raises(ValueError, match="was fitted on a grid of two stages"):
        second_opinion(QUOTIENT, Goal(), replace(made(nodes=9), inner=4))
