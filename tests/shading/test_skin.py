"""Profiles of skin: their constants, what is copied wrongly, and that they keep the light."""

import numpy as np
import pytest
from scipy.special import k0

from shading.skin import (
    PENNER_WIDENED,
    SKIN,
    GaussianProfile,
    burley,
    burley_as_gaussians,
    linear,
    radial,
)


def test_the_weights_are_deons():
    assert SKIN.weights[0] == (0.233, 0.1, 0.118, 0.113, 0.358, 0.078)
    np.testing.assert_allclose(np.sum(SKIN.weights, axis=1), 1.0, atol=1e-15)


@pytest.mark.parametrize(
    ("channel", "index", "slip", "total"), [(0, 5, 0.233, "1.155"), (1, 1, 0.334, "0.998")]
)
def test_weights_that_are_copied_wrongly_are_refused(channel, index, slip, total):
    row = list(SKIN.weights[channel])
    row[index] = slip
    with pytest.raises(ValueError, match=f"add up to {total}: allowed is 1"):
        GaussianProfile(SKIN.variances, (tuple(row),))


def test_the_slip_of_blue_is_refused_too():
    with pytest.raises(ValueError, match=r"add up to 0\.99: allowed is 1"):
        GaussianProfile(SKIN.variances[:4], ((0.649, 0.334, 0.0, 0.007),))


@pytest.mark.parametrize("variance", [0.0, -1.0, float("inf"), float("nan")])
def test_variances_are_positive(variance):
    with pytest.raises(ValueError, match="positive numbers of mm²"):
        GaussianProfile((variance,), ((1.0,),))


def test_other_weights_are_refused():
    with pytest.raises(ValueError, match="allowed are 2 numbers, none negative"):
        GaussianProfile((1.0, 2.0), ((1.5, -0.5),))
    with pytest.raises(ValueError, match="allowed are 2 numbers, none negative"):
        GaussianProfile((1.0, 2.0), ((1.0,),))


def test_penner_widens_by_the_root_of_two_and_not_by_its_misprint():
    np.testing.assert_allclose(np.square(np.divide(PENNER_WIDENED.variances, SKIN.variances)), 2)
    assert not np.allclose(PENNER_WIDENED.variances, np.multiply(SKIN.variances, 1.1414))


def test_a_channel_leaves_out_gaussians_without_weight():
    blue = SKIN.channel(2)
    assert blue.variances == (0.0064, 0.0484, 0.567)
    np.testing.assert_allclose(linear(blue, 0.3)[0], linear(SKIN, 0.3)[2], rtol=1e-15)


def test_the_linear_profile_is_the_integral_of_the_radial_one():
    y = np.linspace(-25, 25, 20001)
    for x in (0.1, 1.0, 4.0):
        distances = np.hypot(x, y)
        v, w = np.array(SKIN.variances), np.array(SKIN.weights)
        over = (np.exp(-(distances[:, None] ** 2) / (2 * v)) / (2 * np.pi * v)) @ w.T
        np.testing.assert_allclose(over[:-1].sum(axis=0) * 50 / 20000, linear(SKIN, x), rtol=1e-9)
        np.testing.assert_allclose(over[10000], radial(SKIN, x), rtol=1e-13)


def test_burleys_profile_is_a_mean_of_gaussians():
    """Also across a line, where it consists of Bessel functions."""
    b = 0.7
    gaussians = burley_as_gaussians(b)
    for d in (1.0, 3.0, 8.0):
        assert float(radial(gaussians, d)[0]) == pytest.approx(float(burley(d, b)), rel=2e-7)
        expected = (k0(d / b) + k0(d / (3 * b))) / (4 * np.pi * b)
        assert float(linear(gaussians, d)[0]) == pytest.approx(expected, rel=2e-8)


def test_a_shape_of_burley_is_positive():
    with pytest.raises(ValueError, match="shape = 0 mm: allowed is a positive number"):
        burley_as_gaussians(0.0)
