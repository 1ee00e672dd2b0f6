"""Fits to scattered points: the least largest error, sides, bounds, and rounded coefficients."""

import functools
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Goal, form_values
from fitting.fit import Fit, fit
from fitting.points.sample import sample_of
from fitting.points.scattered import checking_points, judging_points
from fitting.proofs.range_proof import certify_range
from fitting.solvers.exchange import Exchange
from fitting.solvers.minimax import Minimax
from quantities import problem
from quantities.fuzz.supplement import QUADRATIC_Q
from tests.fitting.toys import QUOTIENT, TOY, toy_form

Q_FORM = problem("q").find_form("pole-q", {"structure": "one", "terms": 1, "poles": 1})
R_FORM = problem("r").find_form(
    "monomial-r",
    {
        "variable": "1-alpha^2",
        "numerator": [[0, 0], [0, 1], [1, 0], [1, 1]],
        "denominator": [[1, 0]],
        "least_alpha": 0.15,
    },
)
ONE_ROOT = problem("ps").find_form("one-root-ps", {"skew": 0, "degree": 1, "least_alpha": 0.15})


# No quotient, and far from its minimum at the start.
STEEP = toy_form(
    lambda c, x, y: jnp.exp(-c[0] * x) * (c[1] + c[2] * y),
    ["rate", "1", "y"],
    starts=(np.array([20.0, 5.0, 5.0]),),
)


# No quotient, and far from its minimum at the start.
STEEP = toy_form(
    lambda c, x, y: jnp.exp(-c[0] * x) * (c[1] + c[2] * y),
    ["rate", "1", "y"],
    starts=(np.array([20.0, 5.0, 5.0]),),
)


@functools.cache
def made(form, goal: Goal) -> Fit:
    return fit(form, goal)


def difference(fitted) -> np.ndarray:
    points, exact = judging_points(fitted.form)
    return form_values(fitted, points) - exact


def test_the_largest_error_is_lower_and_the_rms_higher_than_by_least_squares():
    squares, largest = made(Q_FORM, Goal()), made(Q_FORM, Goal("linf"))
    assert largest.off_grid.largest < 0.95 * squares.off_grid.largest
    assert squares.off_grid.rms < largest.off_grid.rms
    assert largest.range is not None
    # The largest error on the sample is the one elsewhere: the sample is fine enough.
    assert largest.off_grid.largest == pytest.approx(largest.on_grid.largest, rel=1e-3)


@pytest.mark.parametrize(
    ("rounding", "dtype"),
    [("float16", np.float16), ("float32", np.float32)],
)
@pytest.mark.slow
def test_rounded_coefficients_are_better_than_if_simply_rounded(rounding, dtype):
    exact = made(R_FORM, Goal("linf")).fitted
    fitted = made(R_FORM, Goal("linf", rounding=rounding)).fitted
    c = fitted.constants
    np.testing.assert_array_equal(c, c.astype(dtype).astype(float))
    simply = R_FORM.fitted(exact.constants.astype(dtype).astype(float))
    assert np.abs(difference(fitted)).max() <= 1.0001 * np.abs(difference(simply)).max()
    if rounding == "float16":
        assert np.abs(difference(fitted)).max() < 0.99 * np.abs(difference(simply)).max()


@pytest.mark.slow
def test_rounded_least_squares_refit_what_is_left():
    fitted = fit(QUOTIENT, Goal(rounding="float16")).fitted
    c = fitted.constants
    np.testing.assert_array_equal(c, c.astype(np.float16).astype(float))
    simply = QUOTIENT.fitted(fit(QUOTIENT).fitted.constants.astype(np.float16).astype(float))
    rms = [np.sqrt(np.mean(difference(each) ** 2)) for each in (fitted, simply)]
    assert rms[0] < 1.05 * rms[1]


def test_a_fit_from_below_has_no_value_above_the_exact_one():
    below, both = (made(Q_FORM, Goal("linf", side=side)) for side in ("below", "both"))
    # The linear programs are solved to 1e-7.
    assert difference(below.fitted).max() < 3e-6
    assert difference(both.fitted).max() > 3e-4
    assert both.off_grid.largest < below.off_grid.largest < 10 * both.off_grid.largest


def test_relative_errors_are_smaller_when_they_are_asked_for():
    points, exact = judging_points(QUADRATIC_Q)
    plain, relative = (made(QUADRATIC_Q, Goal("linf", relative=each)) for each in (False, True))
    sizes = [np.abs(difference(each.fitted) / exact).max() for each in (plain, relative)]
    assert sizes[1] < 0.95 * sizes[0]
    assert relative.off_grid.largest > plain.off_grid.largest
    assert len(points) == relative.off_grid.points
    # The bound is one of the error itself.
    assert relative.least_error is None and plain.least_error is not None


@pytest.mark.slow
def test_a_quotient_of_linear_functions_has_a_bound_that_is_nearly_attained():
    found = made(R_FORM, Goal("linf"))
    assert found.least_error is not None
    assert 0.98 * found.on_grid.largest < found.least_error <= found.on_grid.largest


@pytest.mark.slow
def test_a_measure_lowers_the_weighted_error():
    points, exact = judging_points(ONE_ROOT)
    density = np.sin(points[:, 2]) * np.cos(points[:, 2])

    def rms(measure):
        error = form_values(fit(ONE_ROOT, measure=measure).fitted, points) - exact
        return np.sqrt(np.average(error**2, weights=density))

    assert rms("cosine") < 0.99 * rms("uniform")


@pytest.mark.slow
def test_a_bounded_fit_is_in_the_unit_interval_where_the_best_one_is_not():
    free, bounded = (fit(ONE_ROOT, Goal("linf", bounded=each)) for each in (False, True))
    points, _ = checking_points(ONE_ROOT, 77)
    assert form_values(free.fitted, points).max() > 1.01
    assert free.range is None
    assert form_values(bounded.fitted, points).max() <= 1
    assert bounded.range is not None
    assert (bounded.range.lower, bounded.range.upper) == (0, 1)
    assert certify_range(bounded.fitted) is not None
    assert free.on_grid.largest < bounded.on_grid.largest < 1.5 * free.on_grid.largest


# The steps of the solver


def test_the_worst_points_of_elsewhere_are_added_to_the_sample():
    """Few fitted points leave a larger error elsewhere, which the exchange makes less."""
    form = replace(QUOTIENT, reference=replace(TOY, sampling=replace(TOY.sampling, fitted=3)))
    goal = Goal("linf")
    once, settled = (
        Exchange(exchanges=count).fit(form, goal, "uniform", None, lambda _: None)
        for count in (1, 8)
    )
    assert len(settled.sample.points) > len(once.sample.points) >= len(sample_of(form).points)
    points, exact = checking_points(QUOTIENT, 5)
    largest = [
        np.abs(form_values(QUOTIENT.fitted(each.coefficients), points) - exact).max()
        for each in (once, settled)
    ]
    assert largest[1] < largest[0]
    assert settled.converged and not once.converged
    assert "the largest error did not settle in 1 exchanges" in once.solver


def test_the_solver_is_tuned_by_its_fields():
    one = Exchange(minimax=Minimax(programs=1), exchanges=1)
    rough, fine = fit(QUOTIENT, Goal("linf"), exchange=one), fit(QUOTIENT, Goal("linf"))
    assert fine.on_grid.largest < rough.on_grid.largest


def test_a_form_that_is_no_quotient_needs_a_start():
    form = toy_form(lambda c, x, y: c[0] * c[1] * x + y, ["a", "b"])
    with pytest.raises(ValueError, match="toy-form has no starts: give one"):
        fit(form)


def test_a_denominator_that_changes_its_sign_whatever_the_coefficients_is_refused():
    form = toy_form(lambda c, x, y: 1 / (c[0] * y + c[1] * y * x), ["y", "xy"])
    with pytest.raises(ValueError, match="no coefficients were found that make its denominator"):
        fit(form)


def test_exact_values_that_change_their_sign_do_not_lead_to_a_pole():
    """The best quotient with any denominator has a pole where the exact values have one."""
    form = toy_form(lambda c, x, y: 1 / (1 + c[0] * (y - 0.5) + c[1] * x), ["y", "x"])
    exact = replace(
        TOY, closed_form=lambda x, y: type(TOY.closed_form(x, y))(1 / (0.02 + y - x), 1e-15 + 0 * x)
    )
    found = fit(replace(form, reference=exact))
    assert found.certificate.holds


def test_starts_that_end_with_poles_are_refused():
    form = toy_form(
        lambda c, x, y: 1 / (c[0] ** 2 * c[0] + 0.0 * x),
        ["a"],
        starts=(np.array([np.nan]),),
        name="poles",
    )
    with pytest.raises(ValueError, match="poles: no start gives a form without poles"):
        fit(form)


def test_a_quotient_whose_own_starts_have_poles_is_fitted_from_others():
    form = replace(QUOTIENT, starts=(np.full(5, np.nan),))
    own, derived = fit(form), fit(QUOTIENT)
    assert own.off_grid.rms == pytest.approx(derived.off_grid.rms, rel=1e-9)


def test_a_coefficient_beyond_float16_is_refused_by_name():
    form = toy_form(lambda c, x, y: 1e-6 * (c[0] + c[1] * x) + y, ["first", "second"])
    with pytest.raises(ValueError, match=r"'first' = .* is too large for float16: allowed are"):
        fit(form, Goal(rounding="float16"))


def test_least_squares_that_do_not_converge_say_so():
    found = Exchange(steps=1).fit(STEEP, Goal(), "uniform", None, lambda _: None)
    assert not found.converged
    assert "least squares did not converge from any of 4 starts" in found.solver
    assert Exchange().fit(STEEP, Goal(), "uniform", None, lambda _: None).converged


def test_a_denominator_whose_fixed_term_should_vanish_is_reported():
    """The exact values are 1/(y + 1) times a constant: no finite c in 1 + c (y + 1) gives them."""
    form = toy_form(lambda c, x, y: c[0] / (1 + c[1] * (y + 1.5)), ["above", "below"])
    exact = replace(
        TOY, closed_form=lambda x, y: type(TOY.closed_form(x, y))(1 / (y + 1.5), 1e-15 + 0 * x)
    )
    found = fit(replace(form, reference=exact))
    assert not found.converged
    assert "let another term of the denominator be 1, such as that of below" in found.solver


def test_each_step_is_told():
    stages = []
    found = fit(QUOTIENT, Goal("linf", rounding="float32"), progress=stages.append)
    c = found.fitted.constants
    np.testing.assert_array_equal(c, c.astype(np.float32).astype(float))
    assert stages == [
        "exact f where quotient is fitted",
        "quotient: least squares",
        "quotient: least largest error",
        "quotient: rounding to float32",
        "quotient: errors and certificate",
    ]
