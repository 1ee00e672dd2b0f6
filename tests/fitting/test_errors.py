"""How far a form is from the exact values, and the search for the largest error."""

from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import Domain, form_values, judge
from fitting.errors import HillClimbing, climb, measure
from fitting.points.grids import sobol_points
from fitting.points.scattered import OFF_GRID_SEED, checking_points, scattered_points
from integrals.reference import box_of
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G
from tests.fitting.toys import AXES

G = [-0.9, 0.4, 0.7, -0.26]
Q = [-1.7, 1.2]


def fitted_form(name: str):
    return resolve(name).require_fitted()


def test_values_of_a_form_are_its_calls():
    fitted = RATIONAL_G.fitted(np.array(G))
    points = sobol_points(RATIONAL_G.axes, 4, seed=11)
    np.testing.assert_allclose(
        form_values(fitted, points), [float(fitted(*x)) for x in points], rtol=1e-15
    )


def test_errors_are_the_weighted_rms_and_the_largest_with_its_place():
    points = np.array([[0.1, 0.2], [0.3, 0.4], [0.2, 0.9]])
    found = measure(np.array([3.0, -5.0, 4.0]), points, RATIONAL_G)
    assert found.rms == pytest.approx((50 / 3) ** 0.5, rel=1e-15)
    assert (found.largest, found.where) == (5.0, {"density": 0.3, "cos_v": 0.4})
    assert found.points == 3
    weighted = measure(np.array([3.0, -5.0, 4.0]), points, RATIONAL_G, np.array([0.25, 0.0, 0.75]))
    assert weighted.rms == pytest.approx((9 / 4 + 12) ** 0.5, rel=1e-15)
    # The weight of a point does not change which error is the largest.
    assert weighted.largest == 5.0


def test_an_error_that_is_not_a_number_is_not_hidden():
    difference = np.array([0.1, np.nan, 0.3])
    found = measure(difference, np.array([[0.1], [0.2], [0.3]]), QUADRATIC_Q)
    assert np.isnan([found.rms, found.largest]).all()


def test_a_form_is_judged_on_points_off_every_grid():
    found = judge(QUADRATIC_Q.fitted(np.array(Q)))
    points = sobol_points(QUADRATIC_Q.axes, 16, seed=20200717)
    d = points[:, 0]
    difference = 1 + Q[0] * d + Q[1] * d**2 - QUADRATIC_Q.reference.values(points)
    assert found.rms == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-12)
    # Hill climbing finds no smaller error, and for a parabola hardly a larger one.
    assert found.largest >= np.abs(difference).max()
    assert found.largest == pytest.approx(np.abs(difference).max(), rel=1e-6)
    assert found.where["density"] == pytest.approx(d[np.argmax(np.abs(difference))], abs=1e-3)


def test_a_form_is_judged_on_another_domain_if_one_is_given():
    fitted = RATIONAL_G.fitted(np.array(G))
    density, cos_v = RATIONAL_G.axes
    part = Domain(RATIONAL_G.reference, (density, replace(cos_v, lower=0.5)))
    found, whole = judge(fitted, part), judge(fitted)
    assert found.where["cos_v"] >= 0.5
    assert found.largest < whole.largest


def test_hill_climbing_finds_a_ridge_between_the_points():
    fitted = fitted_form("published/ps@printed")
    points, exact = checking_points(fitted.form, OFF_GRID_SEED)
    without = np.abs(form_values(fitted, points) - exact).max()
    assert judge(fitted).largest > 1.05 * without


def hill(points: np.ndarray) -> np.ndarray:
    """Return a peak of height 1 at (0.31, 0.77) and a lower one at (0.9, −0.5)."""
    x, y = points.T
    first = np.exp(-200 * ((x - 0.31) ** 2 + (y - 0.77) ** 2))
    return first + 0.5 * np.exp(-200 * ((x - 0.9) ** 2 + (y + 0.5) ** 2))


def test_hill_climbing_goes_up_from_the_worst_point_of_each_cell():
    points = sobol_points(AXES, 8, seed=1)
    sizes = hill(points)
    top = climb(hill, points, sizes, AXES, seed=2)
    assert len(top) == 4**2
    assert hill(top).max() == pytest.approx(1, abs=1e-4)
    assert np.sum(hill(top) > 0.49) >= 2
    lower, upper = box_of(AXES).T
    assert ((top >= lower) & (top <= upper)).all()
    # No cell ends below its worst point.
    assert hill(top).min() >= 0
    np.testing.assert_array_equal(top, climb(hill, points, sizes, AXES, seed=2))


def test_the_number_of_cells_is_chosen():
    points = sobol_points(AXES, 8, seed=1)
    assert len(HillClimbing(cells=2, steps=64)(hill, points, hill(points), AXES, 0)) == 4


@pytest.mark.parametrize(
    "name",
    [
        "best/ps-40",
        pytest.param("published/ps@printed", marks=pytest.mark.slow),
        pytest.param("best/ps-11", marks=pytest.mark.slow),
    ],
)
def test_no_error_at_other_points_is_larger(name):
    """Of 400,000 other points none has an error that is larger by more than half a per cent."""
    fitted = fitted_form(name)
    points = scattered_points(fitted.reference, fitted.axes, 17, seed=987)
    other = np.abs(form_values(fitted, points) - fitted.reference.values(points)).max()
    assert other < 1.005 * judge(fitted).largest
