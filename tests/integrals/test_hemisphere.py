"""The rule of the hemisphere integrates powers of the cosine, and steep functions of it."""

import numpy as np
import pytest

from integrals.rules.hemisphere import hemisphere_rule
from tests.integrals.problems import exact_q


def test_directions_are_unit_vectors_above_the_horizon():
    directions, weights = hemisphere_rule()
    assert directions.shape == (len(weights), 3)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, rtol=1e-15)
    assert np.all(directions[:, 2] > 0)
    assert np.all(weights > 0)


@pytest.mark.parametrize("power", [0, 1, 2, 7])
def test_powers_of_the_cosine(power):
    directions, weights = hemisphere_rule()
    total = np.sum(weights * directions[:, 2] ** power)
    np.testing.assert_allclose(total, 2 * np.pi / (power + 1), rtol=1e-11)


def test_azimuths_are_uniform():
    directions, weights = hemisphere_rule()
    x, y, _ = directions.T
    np.testing.assert_allclose(np.sum(weights * x * x), 2 * np.pi / 3, rtol=1e-11)
    np.testing.assert_allclose([np.sum(weights * x), np.sum(weights * x * y)], 0, atol=1e-13)


@pytest.mark.parametrize("density", [1e-6, 1e-3, 0.1, 1.0])
def test_penetration_of_any_density_is_resolved(density):
    """The average of P_p is Q, also where P_p changes only very near the horizon."""
    directions, weights = hemisphere_rule()
    cosines = directions[:, 2]
    average = np.sum(weights * np.exp(-density / cosines) * cosines) / np.pi
    np.testing.assert_allclose(average, float(exact_q(density)), atol=1e-9)


def test_a_finer_rule_is_more_precise():
    def error(step):
        directions, weights = hemisphere_rule(step, 8)
        average = np.sum(weights * np.exp(-0.3 / directions[:, 2]) * directions[:, 2]) / np.pi
        return abs(average - float(exact_q(0.3)))

    assert error(1 / 4) > 1e3 * error(1 / 12)
