"""Standard errors of coefficients. Certified ones are in test_certified_regression.py."""

import jax.numpy as jnp
import numpy as np
import pytest

from fitting.points.grids import sobol_points
from fitting.points.sample import Sample
from fitting.uncertainty import MOST_CONDITION, uncertainty
from tests.fitting.toys import AXES, PLANE, toy_form

POINTS = sobol_points(AXES, 6, seed=4)
NOISE = np.random.default_rng(8).normal(size=len(POINTS))
TRUE = np.array([1.0, -2.0, 0.5])
VALUES = TRUE[0] + POINTS @ TRUE[1:]


def fitted_plane(scale: np.ndarray):
    matrix = np.column_stack([np.ones(len(POINTS)), POINTS]) * scale[:, None]
    z = np.linalg.lstsq(matrix, (VALUES + 0.1 * NOISE) * scale, rcond=None)[0]
    return PLANE.fitted(z), Sample(POINTS, VALUES + 0.1 * NOISE, 0.0, scale), matrix


@pytest.mark.parametrize("scale", [np.ones(64), np.linspace(0.1, 3, 64)])
def test_standard_errors_of_a_linear_form_are_those_of_the_normal_equations(scale):
    plane, sample, matrix = fitted_plane(scale)
    error = matrix @ plane.constants - sample.exact * scale
    variance = error @ error / (64 - 3)
    expected = np.sqrt(variance * np.diag(np.linalg.inv(matrix.T @ matrix)))
    np.testing.assert_allclose(uncertainty(plane, sample).standard_errors, expected, rtol=1e-10)


def test_coefficients_that_only_their_sum_determines_are_named():
    form = toy_form(lambda c, x, y: (c[0] + c[1]) * x + c[2] * y, ["one", "other", "y"])
    sample = Sample(POINTS, VALUES, 0.0, np.ones(64))
    found = uncertainty(form.fitted(np.array([1.0, 2.0, 3.0])), sample)
    assert not found.unique and found.condition > MOST_CONDITION
    assert found.undetermined == ("one", "other")
    np.testing.assert_array_equal(np.isinf(found.standard_errors), [True, True, False])
    direction = found.worst_direction * np.sign(found.worst_direction[0])
    np.testing.assert_allclose(direction, [np.sqrt(0.5), -np.sqrt(0.5), 0], atol=1e-7)


def test_a_coefficient_without_effect_is_named():
    form = toy_form(lambda c, x, y: c[0] * x + 0 * c[1] * y, ["x", "nothing"])
    found = uncertainty(form.fitted(np.ones(2)), Sample(POINTS, VALUES, 0.0, np.ones(64)))
    assert found.undetermined == ("nothing",) and found.condition == np.inf


def test_what_has_no_standard_errors_is_refused():
    few = Sample(POINTS[:3], VALUES[:3], 0.0, np.ones(3))
    with pytest.raises(ValueError, match=r"3 points for 3 coefficients of plane: .* at least 4"):
        uncertainty(PLANE.fitted(TRUE), few)
    with pytest.raises(ValueError, match="fixed has no coefficients"):
        uncertainty(toy_form(lambda c, x, y: x + y, [], name="fixed").fitted(np.zeros(0)), few)
    form = toy_form(lambda c, x, y: jnp.log(c[0] * x), ["a"], name="log")
    with pytest.raises(ValueError, match="slopes of log are not finite"):
        sample = Sample(POINTS, VALUES, 0.0, np.ones(64))
        uncertainty(form.fitted(-np.ones(1)), sample)
