"""Least squares fits on a tensor grid: by QR, and by Levenberg–Marquardt from a linear start."""

import functools

import jax.numpy as jnp
import numpy as np
import pytest

from fitting import form_values
from fitting.points.grids import gauss_grid, trapezoid_grid
from fitting.solvers import on_grid
from fitting.solvers.least_squares import solve_nonlinear_jaxopt
from fitting.solvers.on_grid import OnGrid, solve_in_general
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G
from tests.fitting.minima import misfit, possible_gain, replace_solver, worst_of
from tests.fitting.toys import PLANE, QUOTIENT, TOY, toy_form

FORMS = {form.name: form for form in (QUADRATIC_Q, RATIONAL_G, PLANE, QUOTIENT)}
# Coefficients of moderate size, whose denominators have no zero.
SYNTHETIC = {
    "rational-g": [-0.8, 0.3, 0.9, -0.2],
    "quadratic-q": [-1.5, 0.7],
    "plane": [0.3, -2.0, 0.5],
    "quotient": [0.3, -2.0, 0.5, 0.7, 0.2],
}


@functools.cache
def problem(name: str):
    form = FORMS[name]
    grid = gauss_grid(form.axes, 17)
    return form, grid, jnp.asarray(form.reference.values(grid.points))


@functools.cache
def fitted(name: str):
    return solve_in_general(*problem(name))


def norm(name: str, coefficients) -> float:
    return float(np.linalg.norm(misfit(*problem(name)[:2], coefficients, problem(name)[2])))


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_recovered_from_its_own_values(name):
    form, grid, _ = problem(name)
    values = form_values(form.fitted(np.array(SYNTHETIC[name])), grid.points)
    found, _ = solve_in_general(form, grid, jnp.asarray(values))
    assert np.abs(misfit(form, grid, found, values)).max() < 1e-8


@pytest.mark.parametrize("name", FORMS)
def test_no_direction_in_the_coefficients_lowers_the_error(name):
    form, grid, exact = problem(name)
    assert possible_gain(form, grid, fitted(name)[0], exact) < 1e-3


def test_a_linear_form_is_solved_by_qr_as_by_numpy():
    _, grid, exact = problem("quadratic-q")
    density, root = grid.points[:, 0], np.sqrt(grid.weights)
    matrix = np.stack([density, density**2], axis=1) * root[:, None]
    expected = np.linalg.lstsq(matrix, (np.asarray(exact) - 1) * root, rcond=None)[0]
    found, solver = fitted("quadratic-q")
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert solver == fitted("plane")[1] == "QR"


@pytest.mark.parametrize("name", ["rational-g", pytest.param("quotient", marks=pytest.mark.slow)])
def test_the_second_solver_ends_in_the_same_minimum(monkeypatch, name):
    form, grid, exact = problem(name)
    first, solver = fitted(name)
    assert solver == "Levenberg–Marquardt (optimistix)"
    replace_solver(monkeypatch, on_grid, solve_nonlinear_jaxopt, "_fit")
    second, _ = solve_in_general(form, grid, exact)
    assert not np.array_equal(first, second)
    assert norm(name, second) == pytest.approx(norm(name, first), rel=1e-6)
    # It is the same function, not only one that is as good.
    apart = form_values(form.fitted(second), grid.points)
    apart = apart - form_values(form.fitted(first), grid.points)
    assert np.abs(apart).max() < 1e-3 * np.abs(misfit(form, grid, first, exact)).max() * 17


@pytest.mark.parametrize("name", ["quotient", pytest.param("rational-g", marks=pytest.mark.slow)])
def test_the_worst_of_several_starts_is_as_good(monkeypatch, name):
    replace_solver(monkeypatch, on_grid, worst_of(6, 0.1), "_fit")
    found, _ = solve_in_general(*problem(name))
    assert norm(name, found) == pytest.approx(norm(name, fitted(name)[0]), rel=1e-6)


def wave(**options):
    """Return a form that is no quotient of linear functions: an exponential of a coefficient."""
    return toy_form(
        lambda c, x, y: jnp.exp(-c[0] * x) * (c[1] + jnp.sin(y)), ["rate", "1"], **options
    )


def test_a_form_that_is_no_quotient_needs_a_start():
    grid = gauss_grid(TOY.axes, 9)
    exact = jnp.asarray(TOY.values(grid.points))
    with pytest.raises(ValueError, match="toy-form has no starts: give one"):
        solve_in_general(wave(), grid, exact)
    found, _ = solve_in_general(wave(starts=(np.array([0.2, 1.0]),)), grid, exact)
    np.testing.assert_allclose(found, [1, 2], rtol=1e-6)


def test_of_several_starts_the_best_end_is_taken():
    grid = gauss_grid(TOY.axes, 9)
    exact = jnp.asarray(TOY.values(grid.points))
    # From the first start no value is a number.
    starts = (np.array([np.nan, 1.0]), np.array([0.2, 1.0]))
    for some in (starts, starts[::-1]):
        found, _ = solve_in_general(wave(starts=some), grid, exact)
        np.testing.assert_allclose(found, [1, 2], rtol=1e-6)


def test_errors_are_measured_on_the_grid_of_the_fit():
    stages = []
    found = OnGrid().fit(PLANE, 9, "uniform", stages.append)
    assert found.grid.spacing == "gauss-legendre"
    points = found.grid.points
    difference = form_values(PLANE.fitted(found.coefficients), points) - TOY.values(points)
    rms = np.sqrt(found.grid.weights @ difference**2)
    assert found.on_grid.rms == pytest.approx(rms, rel=1e-12)
    assert found.on_grid.largest == pytest.approx(np.abs(difference).max(), rel=1e-12)
    place = np.argmax(np.abs(difference))
    assert list(found.on_grid.where.values()) == found.grid.points[place].tolist()
    assert (found.on_grid.points, found.inner, found.measure) == (81, 0, "uniform")
    assert found.reference_error == 1e-15
    assert [len(stages), "f" in stages[0], PLANE.name in stages[1]] == [3, True, True]


def test_a_solver_of_ones_own_is_given_the_grid_and_the_exact_values():
    def solve(grid, exact):
        np.testing.assert_array_equal(exact, TOY.values(grid.points))
        return jnp.array([1.0, 2.0, 3.0])

    for words, said in ((None, "Levenberg–Marquardt (optimistix)"), ("by hand", "by hand")):
        found = OnGrid(trapezoid_grid, solve, words).fit(PLANE, 5, "uniform", lambda _: None)
        np.testing.assert_array_equal(found.coefficients, [1, 2, 3])
        assert (found.grid.spacing, found.solver) == ("uniform", said)
        assert found.converged is None


@pytest.mark.parametrize("form", [PLANE, QUOTIENT], ids=lambda form: form.name)
def test_a_fit_on_a_grid_says_whether_it_converged(form, monkeypatch):
    good = OnGrid().fit(form, 9, "uniform", lambda _: None)
    assert good.converged and "not converge" not in good.solver
    worse = jnp.asarray(good.coefficients) * 1.01
    monkeypatch.setattr(on_grid, "solve_in_general", lambda *_: (worse, "moved"))
    bad = OnGrid().fit(form, 9, "uniform", lambda _: None)
    assert bad.converged is False
    assert bad.solver == "moved; least squares did not converge"
