import jax
import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.catalogue import form_of, load
from fitting.errors import (
    OFF_GRID_SEED,
    check_reference,
    exact_estimates,
    exact_values,
    form_values,
    measure,
    off_grid_errors,
    off_grid_reference,
)
from fitting.paper import PAPER_FORMS, QuadraticQ, RationalG, RationalR
from fitting.points.grids import gauss_grid, off_grid_points, trapezoid_grid
from fitting.points.scattered import COUNTS, spread_points
from fitting.velvet import ConservativeNorm
from integrals import INTEGRALS, PS, Q, R

FORMS = {form.integral.name: form for form in (*PAPER_FORMS.values(), ConservativeNorm)}
C = {"g": [-0.9, 0.4, 0.7, -0.26], "q": [-1.7, 1.2]}


def some_points(name: str, exponent: int) -> np.ndarray:
    return off_grid_points(FORMS[name].axes, exponent, seed=11)


@pytest.mark.parametrize("name", INTEGRALS)
def test_exact_values_are_those_of_the_reference_leg(name):
    points = some_points(name, 3)
    integral = INTEGRALS[name]
    value = jax.jit(integral.value)
    expected = [float(value(*x)) for x in points]
    # R by 32² nodes here, by 96² as the leg's own default: 2e-8 apart at most
    tolerance = {"r": 2e-8}.get(name, 1e-15)
    np.testing.assert_allclose(exact_values(integral, points), expected, rtol=0, atol=tolerance)
    estimates = exact_estimates(integral, points)
    np.testing.assert_allclose(estimates.value, expected, rtol=0, atol=tolerance)
    assert (np.abs(estimates.value - np.array(expected)) <= np.asarray(estimates.error)).all()


def test_r_is_exact_to_2e_8_where_the_errors_of_its_fits_are_measured():
    # the corners and edges with the least α are where R is hardest
    hardest = [(0.15, theta) for theta in np.linspace(0, np.pi / 2, 9)]
    finer = jax.jit(lambda alpha, theta_f: R.quadrature(alpha, theta_f, nodes=128).value)
    expected = [float(finer(*x)) for x in hardest]
    np.testing.assert_allclose(exact_values(R, np.array(hardest)), expected, rtol=0, atol=2e-8)


def test_values_of_a_form_are_its_calls():
    form = RationalG(jnp.array(C["g"]))
    points = some_points("g", 4)
    np.testing.assert_allclose(
        form_values(form, points), [float(form(*x)) for x in points], rtol=1e-15
    )


def test_errors_are_the_weighted_rms_and_the_largest_with_its_place():
    points = np.array([[0.1, 0.2], [0.3, 0.4], [0.2, 0.9]])
    found = measure(np.array([3.0, -5.0, 4.0]), points, RationalG)
    assert found.rms == pytest.approx((50 / 3) ** 0.5, rel=1e-15)
    assert (found.largest, found.where) == (5.0, {"density": 0.3, "cos_v": 0.4})
    assert found.points == 3
    weighted = measure(np.array([3.0, -5.0, 4.0]), points, RationalG, np.array([0.25, 0.0, 0.75]))
    assert weighted.rms == pytest.approx((9 / 4 + 12) ** 0.5, rel=1e-15)
    # The largest error is one, whatever weight its point has.
    assert weighted.largest == 5.0


def test_the_off_grid_set_is_fixed_and_no_grid_has_any_of_its_points():
    points, exact = off_grid_reference(RationalG)
    assert points.shape == (2**16, 2)
    again = off_grid_points(RationalG.axes, COUNTS["g"].judged, seed=20200717)
    np.testing.assert_array_equal(points, again)
    first = exact_values(RationalG.integral, points[:64])
    np.testing.assert_allclose(exact[:64], first, rtol=1e-14)
    for make in (trapezoid_grid, gauss_grid):
        for column, nodes in zip(points.T, make(RationalG.axes, 65).nodes, strict=True):
            assert not np.isin(column, nodes).any()
    # Enough points that the largest error is nearly found.
    assert min(each.judged for each in COUNTS.values()) >= 12
    assert off_grid_reference(RationalR)[0].shape[0] == 2 ** COUNTS["r"].judged


def test_off_grid_errors_are_those_on_the_off_grid_set():
    form = QuadraticQ(jnp.array(C["q"]))
    found = off_grid_errors(form)
    points = off_grid_points(QuadraticQ.axes, 16, seed=20200717)
    d = points[:, 0]
    difference = 1 + C["q"][0] * d + C["q"][1] * d**2 - exact_values(Q, points)
    assert found.rms == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-12)
    # What is found uphill is no less, and for a parabola no more to speak of.
    assert found.largest >= np.abs(difference).max()
    assert found.largest == pytest.approx(np.abs(difference).max(), rel=1e-6)
    assert found.where["density"] == pytest.approx(d[np.argmax(np.abs(difference))], abs=1e-3)


def test_a_ridge_between_the_points_is_found():
    form = form_of(load("published/ps@printed"))
    points, exact = check_reference(type(form), OFF_GRID_SEED)
    without = np.abs(form_values(form, points) - exact).max()
    assert off_grid_errors(form).largest > 1.05 * without


@pytest.mark.parametrize("name", ["published/ps@printed", "best/ps-11", "best/ps-40"])
def test_no_error_at_other_points_is_larger(name):
    """Of 400,000 other points none has an error that is larger by more than half a per cent."""
    form = form_of(load(name))
    points = spread_points("ps", type(form).axes, 17, seed=987)
    other = np.abs(form_values(form, points) - exact_values(PS, points)).max()
    assert other < 1.005 * off_grid_errors(form).largest


def test_a_form_that_is_no_number_somewhere_has_an_error_that_is_none():
    difference = np.array([0.1, np.nan, 0.3])
    found = measure(difference, np.array([[0.1], [0.2], [0.3]]), QuadraticQ)
    assert np.isnan([found.rms, found.largest]).all()
