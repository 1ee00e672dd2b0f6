"""Descents from one start. tests/fitting/test_certified_regression.py has real problems."""

import numpy as np
import pytest

from fitting.solvers import scattered_squares
from fitting.solvers.descent import Descent, descend
from fitting.solvers.residuals import Residuals, residuals
from fitting.solvers.scattered_squares import fit_squares
from tests.fitting.toys import toy_form


def rosenbrock(z):
    return np.array([10 * (z[1] - z[0] ** 2), 1 - z[0]])


def rosenbrock_slopes(z):
    return np.array([[-20 * z[0], 10.0], [-1.0, 0.0]])


@pytest.mark.parametrize("start", [(-1.2, 1.0), (30.0, -10.0), (1.0, 1.0)])
def test_an_exact_solution_is_found_to_rounding(start):
    end = descend(rosenbrock, rosenbrock_slopes, np.array(start), 200)
    assert end.converged
    np.testing.assert_allclose(end.z, 1, rtol=1e-12)


def test_too_few_steps_are_told():
    end = descend(rosenbrock, rosenbrock_slopes, np.array([-1.2, 1.0]), 3)
    assert not end.converged
    assert 0.1 < end.norm < np.linalg.norm(rosenbrock(np.array([-1.2, 1.0])))


X = np.linspace(0, 1, 30)


@pytest.mark.parametrize("size", [1e-8, 1.0, 1e8])
def test_the_scale_of_coefficients_does_not_matter(size):
    """A linear problem with columns of very different size, which normal equations cannot solve."""
    matrix = np.vander(X, 9, increasing=True) * size ** (np.arange(9) / 4)
    values = np.exp(X)
    end = descend(lambda z: matrix @ z - values, lambda _: matrix, np.zeros(9))
    expected = np.polynomial.Polynomial.fit(X, values, 8)(X)
    np.testing.assert_allclose(matrix @ end.z, expected, atol=1e-13)
    assert end.converged


def test_what_is_not_finite_is_not_entered():
    def residual(z):
        with np.errstate(invalid="ignore"):
            return np.log(z) * np.ones(2)

    end = descend(residual, lambda z: np.ones((2, 1)) / z, np.array([30.0]))
    assert end.converged
    np.testing.assert_allclose(end.z, 1, rtol=1e-12)
    bad = descend(residual, lambda z: np.ones((2, 1)) / z, np.array([-1.0]))
    assert not bad.converged and bad.norm == np.inf


def test_a_residual_whose_square_overflows_is_not_entered():
    """The first step goes to where e^(z²) is above 1e154."""
    end = descend(
        lambda z: np.exp(np.minimum(z**2, 700.0)) * np.array([1.0, 1.0]) - [3.0, 5.0],
        lambda z: 2 * z * np.exp(z**2) * np.ones((2, 1)),
        np.array([0.02]),
    )
    assert end.converged
    np.testing.assert_allclose(end.z**2, np.log(4), rtol=1e-9)
    above = descend(lambda z: 1e200 * z, lambda z: 1e200 * np.eye(2), np.ones(2))
    assert not above.converged and above.norm == np.inf


def test_a_flat_residual_ends_at_the_start():
    end = descend(lambda z: np.ones(3), lambda z: np.zeros((3, 2)), np.array([1.0, 2.0]))
    np.testing.assert_array_equal(end.z, [1, 2])
    assert end.norm == pytest.approx(np.sqrt(3))


POINTS = np.column_stack([X, 0 * X])
NARROW = toy_form(lambda c, x, y: c[0] / (c[1] + x), ["above", "offset"], name="narrow")


def narrow_problem(offset: float):
    exact = 1 / (offset + X)
    return residuals(NARROW, POINTS, exact, np.ones(30), np.full(2, True), np.zeros(2))


@pytest.mark.parametrize("offset", [1.0, 1e-3, 1e-5])
@pytest.mark.parametrize("start", [[1.0, 1.0], [2.0, -0.5]])
def test_small_denominators_are_not_biased(offset, start):
    """A penalty for denominators below 1e-2 would move the solution; only a pole has one."""
    found = fit_squares(narrow_problem(offset), [np.array(start)])
    assert found is not None and found.converged
    np.testing.assert_allclose(found.z, [1, offset], rtol=1e-9)


def test_the_better_of_two_ends_is_kept():
    form = toy_form(lambda c, x, y: c[0] ** 2 * x + c[0] * (1 - x) / 2, ["a"], name="wells")
    exact = X - (1 - X) / 2
    problem = residuals(form, POINTS, exact, np.ones(30), np.full(1, True), np.zeros(1))
    starts = [np.array([1.0]), np.array([-2.0])]
    right, left = (fit_squares(problem, [start]) for start in starts)
    assert right is not None and left is not None
    assert right.converged and right.z[0] > 0.5
    np.testing.assert_allclose(left.z, -1, rtol=1e-12)
    both = fit_squares(problem, starts)
    assert both is not None and both.tried == 2
    np.testing.assert_array_equal(both.z, left.z)


def followed(monkeypatch, places, converged=False):
    """Let every descent go through these places, and return the list of their residuals."""
    residuals_of = []

    def descend(residual, _jacobian, start, *_):
        residuals_of.append(residual)
        found = [residual(np.array([z])) for z in places]
        end = np.array([places[-1]])
        return Descent(end, float(np.linalg.norm(found[-1])), converged)

    monkeypatch.setattr(scattered_squares, "descend", descend)
    return residuals_of


def halfline() -> Residuals:
    """A problem of one coefficient z, which must be positive."""
    return Residuals(
        values=lambda z: z * np.ones(3),
        slopes=lambda z, rows: np.ones((len(rows), 1)),
        positive=lambda z: z * np.ones(3),
        positive_slopes=lambda z, rows: np.ones((len(rows), 1)),
        least=np.full(3, -np.inf),
        most=np.full(3, np.inf),
        exact=np.zeros(3),
        scale=np.ones(3),
    )


def test_a_descent_that_met_no_pole_is_not_repeated_without_its_guard(monkeypatch):
    done = followed(monkeypatch, [2.0, 1.0])
    found = fit_squares(halfline(), [np.array([3.0])], near=0)
    assert found is not None and found.z == [1.0] and not found.converged
    assert len(done) == 1


def test_a_descent_that_met_a_pole_is_repeated_without_its_guard(monkeypatch):
    done = followed(monkeypatch, [2.0, -1.0, 1.0])
    fit_squares(halfline(), [np.array([3.0])], near=0)
    guarded, free = done
    assert np.isinf(guarded(np.array([-1.0]))).all()
    np.testing.assert_array_equal(free(np.array([-1.0])), -1)


@pytest.mark.parametrize(
    ("places", "worthwhile", "count"),
    [
        ([-1.0, 3.0, 2.0, 1.0], 1e-8, 1),
        ([-1.0, 3.0, 2.0, 1.0], 1e-15, 2),
        ([3.0, 2.0, -1.0, 1.0], 1e-8, 2),
    ],
    ids=["early", "early but not rough", "late"],
)
def test_a_rough_descent_that_met_a_pole_early_is_not_repeated(
    monkeypatch, places, worthwhile, count
):
    done = followed(monkeypatch, places)
    fit_squares(halfline(), [np.array([3.0])], worthwhile=worthwhile, near=0)
    assert len(done) == count
