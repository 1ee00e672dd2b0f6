"""The trust region method takes the steps of SciPy's, to the last digit."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from fitting.solvers.trust_region import search

X = np.linspace(0.01, 1, 60)


def exponentials(z):
    return z[0] * np.exp(-z[1] * X) + z[2] * np.exp(-z[3] * X) - 1 / (1 + 5 * X)


def exponentials_slopes(z):
    one, other = np.exp(-z[1] * X), np.exp(-z[3] * X)
    return np.asfortranarray(np.stack([one, -z[0] * X * one, other, -z[2] * X * other], axis=1))


def dependent(z):
    """The first two coefficients only occur as a sum."""
    return (z[0] + z[1]) * X + z[2] ** 2 - np.cos(X)


def dependent_slopes(z):
    return np.stack([X, X, 2 * z[2] + 0 * X], axis=1)


def few(z):
    """Fewer points than coefficients."""
    return np.array([z[0] * z[1] - 2, z[1] + z[2] ** 2 - 3])


def few_slopes(z):
    return np.array([[z[1], z[0], 0.0], [0.0, 1.0, 2 * z[2]]])


def logarithm(z):
    """Not finite for z ≤ 0, where long first steps lead."""
    return np.log(z[0] * X) - z[1] / z[0]


def logarithm_slopes(z):
    return np.stack([1 / z[0] + z[1] / z[0] ** 2 + 0 * X, -1 / z[0] + 0 * X], axis=1)


def broken_slopes(z):
    return np.full((2, 3), np.nan) if z[0] > 1.5 else few_slopes(z)


PROBLEMS = [
    (exponentials, exponentials_slopes, [0.0, 0.5, 0.0, 20.0]),
    (exponentials, exponentials_slopes, [1.0, 1.0, 1.0, 1.0]),
    (exponentials, exponentials_slopes, [0.0, 0.0, 0.0, 0.0]),
    (dependent, dependent_slopes, [1.0, 2.0, 3.0]),
    (few, few_slopes, [1.0, 1.0, 1.0]),
    (few, broken_slopes, [1.0, 1.0, 1.0]),
    (logarithm, logarithm_slopes, [0.05, 3.0]),
]


def recorded(function):
    """Return a function that is ∞ where another one is not finite, and where it was evaluated."""
    places = []

    def record(z):
        places.append(np.array(z))
        found = function(z)
        return found if np.isfinite(found).all() else np.full_like(found, np.inf)

    return record, places


@pytest.mark.parametrize("steps", [3, 200])
@pytest.mark.parametrize("worthwhile", [1e-15, 1e-8])
@pytest.mark.parametrize(("function", "slopes", "start"), PROBLEMS)
def test_it_is_evaluated_where_scipy_evaluates(function, slopes, start, worthwhile, steps):
    z = np.array(start)
    ours, our_places = recorded(function)
    theirs, their_places = recorded(function)
    with np.errstate(all="ignore"):
        search(ours, slopes, z, ours(z), steps, worthwhile, 1e-15)
        try:
            least_squares(
                theirs, z, slopes, x_scale="jac", ftol=worthwhile, xtol=1e-15, gtol=None,
                max_nfev=steps,
            )  # fmt: skip
        except ValueError:
            assert slopes is broken_slopes
    assert len(their_places) > 2
    np.testing.assert_array_equal(our_places, their_places)


def test_a_jacobian_that_is_not_finite_ends_the_search():
    places = []

    def residual(z):
        places.append(z)
        return few(z)

    z = np.ones(3)
    with np.errstate(all="ignore"):
        search(residual, lambda z: np.full((2, 3), np.inf), z, few(z), 100, 1e-8, 1e-15)
    assert not places
