import dataclasses
import sys

import numpy as np
import pytest

from fitting import Goal, form_values, improve
from fitting.errors import check_reference, off_grid_reference
from fitting.families.ps import cubic_ps, one_root_ps
from fitting.families.q import pole_q
from fitting.families.r import monomial_r
from fitting.grow import grown_r
from fitting.paper import QuadraticQ, RationalPs

Q_FORM = pole_q(structure="one", terms=1, poles=1)
R_FORM = monomial_r(
    variable="1-alpha^2",
    numerator=((0, 0), (0, 1), (1, 0), (1, 1)),
    denominator=((1, 0),),
    least_alpha=0.15,
)


def difference(fit) -> np.ndarray:
    points, exact = off_grid_reference(type(fit.form))
    return form_values(fit.form, points) - exact


def test_the_largest_error_is_lower_and_the_rms_higher_than_by_least_squares():
    squares, largest = improve(Q_FORM, Goal()), improve(Q_FORM, Goal("linf"))
    assert largest.off_grid.largest < 0.95 * squares.off_grid.largest
    assert squares.off_grid.rms < largest.off_grid.rms
    assert largest.range is not None
    # The largest error on the sample is the one elsewhere: the sample is fine enough.
    assert largest.off_grid.largest == pytest.approx(largest.on_grid.largest, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("rounding", "dtype"), [("float32", np.float32), ("float16", np.float16)])
def test_rounded_coefficients_are_representable_and_better_than_if_simply_rounded(rounding, dtype):
    exact = improve(R_FORM, Goal("linf"))
    fit = improve(R_FORM, Goal("linf", rounding=rounding))
    c = np.asarray(fit.form.coefficients)
    np.testing.assert_array_equal(c, c.astype(dtype).astype(float))
    simply = R_FORM(np.asarray(exact.form.coefficients).astype(dtype).astype(float))
    simply = dataclasses.replace(exact, form=simply)
    assert np.abs(difference(fit)).max() <= 1.0001 * np.abs(difference(simply)).max()
    if rounding == "float16":
        assert np.abs(difference(fit)).max() < 0.99 * np.abs(difference(simply)).max()


def test_a_fit_from_below_creates_no_energy():
    fit, both = (improve(Q_FORM, Goal("linf", side=side)) for side in ("below", "both"))
    # The linear programs are solved to 1e-7.
    assert difference(fit).max() < 3e-6
    assert difference(both).max() > 3e-4
    assert both.off_grid.largest < fit.off_grid.largest < 10 * both.off_grid.largest


@pytest.mark.slow
def test_relative_errors_are_smaller_when_they_are_asked_for():
    points, exact = off_grid_reference(QuadraticQ)
    start = np.array([-1.7, 1.3])
    plain, relative = (
        improve(QuadraticQ, Goal("linf", relative=relative), start=start)
        for relative in (False, True)
    )
    sizes = [np.abs(difference(fit) / exact).max() for fit in (plain, relative)]
    assert sizes[1] < 0.95 * sizes[0]
    assert relative.off_grid.largest > plain.off_grid.largest
    assert len(points) == relative.off_grid.points


def test_a_quotient_of_linear_functions_has_a_bound_that_is_nearly_attained():
    fit = improve(R_FORM, Goal("linf"))
    assert fit.lower_bound is not None
    assert 0.98 * fit.on_grid.largest < fit.lower_bound <= fit.on_grid.largest


def test_a_form_without_coefficients_is_measured_and_certified():
    fit = improve(cubic_ps(steps=0, degree=-1, least_alpha=0.15), Goal("linf", rounding="float32"))
    assert fit.certificate.holds
    assert 0.01 < fit.off_grid.largest < 0.0125
    assert np.size(fit.form.coefficients) == 0


def test_least_squares_has_no_side_and_no_bounds():
    with pytest.raises(ValueError, match="side = 'below'"):
        Goal("l2", side="below")
    with pytest.raises(ValueError, match="bounded = True with norm = 'l2'"):
        Goal(bounded=True)


def test_a_bounded_fit_that_is_not_proven_to_be_is_refused(monkeypatch):
    # The module, which the function of the same name hides.
    monkeypatch.setattr(sys.modules["fitting.improve"], "certify_range", lambda _: None)
    with pytest.raises(ValueError, match="not shown to be between 0 and 1"):
        improve(Q_FORM, Goal("linf", bounded=True))


def test_what_no_proof_is_known_for_is_refused_at_once():
    with pytest.raises(ValueError, match="no proof is known that would bound rational-ps"):
        improve(RationalPs, Goal("linf", bounded=True), start=np.zeros(162))


@pytest.mark.slow
def test_a_bounded_fit_is_a_fraction_where_the_best_one_is_not():
    form = one_root_ps(skew=0, degree=1, least_alpha=0.15)
    free, bounded = (improve(form, Goal("linf", bounded=each)) for each in (False, True))
    points, _ = check_reference(form, 77)
    assert form_values(free.form, points).max() > 1.01
    assert free.range is None
    assert form_values(bounded.form, points).max() <= 1
    assert bounded.range is not None
    assert (bounded.range.lower, bounded.range.upper) == (0, 1)
    assert free.on_grid.largest < bounded.on_grid.largest < 1.5 * free.on_grid.largest


@pytest.mark.slow
def test_the_sets_of_monomials_grow_by_one_and_improve():
    forms = []
    for form in grown_r(0.15):
        forms.append(form)
        if len(forms) == 6:
            break
    sizes = [len(form.coefficient_names()) for form in forms]
    assert sizes == list(range(sizes[0], sizes[0] + 6))
    first, last = (improve(form, Goal()).off_grid.rms for form in (forms[0], forms[-1]))
    assert last < 0.1 * first
