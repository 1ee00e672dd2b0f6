"""What a bend of D adds to the hidden area, against its integral with 30 digits."""

import jax
import mpmath as mp
import numpy as np
import pytest

from shading.piecewise.bend_areas import bend_areas
from shading.piecewise.hidden_area import beyond_edge

# The knot is so far beyond the edge E = π/2 − θo: near it T is of the seventh power of that.
BEYOND = (1e-5, 1e-2, 0.1, 0.4)
_areas = jax.jit(bend_areas)


def exact(theta: float, theta_o: float):
    """Return T by the definition of H for D = max(cos²θ′ − cos²θ, 0): an integral over A."""
    with mp.workdps(30):
        sine, cosine = mp.sin(theta_o), mp.cos(theta_o)
        level = mp.cos(theta) ** 2
        end = mp.acos(min(mp.cos(theta) / sine, mp.mpf(1)))

        def integrand(a):
            opened = mp.atan2(mp.sin(a), cosine * mp.cos(a))
            kernel = mp.sin(a) - cosine * mp.cos(a) * opened
            return (sine**2 * mp.cos(a) ** 2 - level) * kernel * mp.sin(a)

        cuts = [end * part for part in (0, mp.mpf(1) / 8, mp.mpf(1) / 2, 1)]
        return 2 * sine**2 * mp.quad(integrand, cuts)


@pytest.mark.parametrize("theta_o", [0.3, 1.0, 1.5, 1.57])
def test_a_bend_has_full_relative_precision(theta_o):
    theta = np.pi / 2 - theta_o + np.array(BEYOND)
    theta = theta[theta < np.pi / 2]
    found = np.asarray(_areas(*beyond_edge(theta, theta_o), theta_o))
    wanted = [exact(float(each), theta_o) for each in theta]
    # T is of the 3.5th power of the distance to the edge, which is rounded: that is the 1e-9.
    limits = 1e-13 + 8e-16 / (theta - (np.pi / 2 - theta_o))
    for value, each, limit in zip(found, wanted, limits, strict=True):
        assert abs(value - each) <= limit * each


def test_nothing_is_added_before_the_edge():
    np.testing.assert_array_equal(_areas(*beyond_edge(np.array([0.1, 0.2]), 1.2), 1.2), 0)
