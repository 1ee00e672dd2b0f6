"""Scrambled Sobol' points against those of SciPy."""

import numpy as np
import pytest
from scipy.stats import qmc

from fitting.points.grids import unit_points
from fitting.points.sobol import MOST_DIMENSIONS


@pytest.mark.parametrize("count", range(1, MOST_DIMENSIONS + 2))
@pytest.mark.parametrize(("exponent", "seed"), [(0, 1), (1, 2), (11, 20200717)])
def test_points_are_those_of_scipy_to_the_last_bit(count, exponent, seed):
    wanted = qmc.Sobol(count, rng=np.random.default_rng(seed)).random_base2(exponent)
    np.testing.assert_array_equal(unit_points(count, exponent, seed), wanted)
