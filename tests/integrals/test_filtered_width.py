"""The widening of filtered lobes: known values, independent legs, and limits."""

import jax
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import exp1

from integrals import SGGX_FILTER, SGGX_FILTER_AXES
from integrals.maps.filtered_width import (
    MIRROR,
    axis_widening,
    axis_widening_by_sampling,
    widening,
)

# g = α'²/α² of the best lobe for a relative spread t, computed apart from this package.
RATIOS = [
    (0.01, 1.019883),
    (0.1, 1.190424),
    (1.0, 2.613386),
    (3.0, 5.379567),
    (10.0, 14.40668),
    (1000.0, 1224.868),
]


@pytest.mark.parametrize(("t", "ratio"), RATIOS)
@pytest.mark.slow
def test_known_ratios(t, ratio):
    found = widening(t / (1 + t))
    # The values have seven digits.
    assert float(found.value) * (1 + t) == pytest.approx(ratio, rel=5e-7)


@pytest.mark.slow
def test_ends():
    assert widening(0.0).value == pytest.approx(1, abs=1e-13)
    assert widening(1.0).value == pytest.approx(MIRROR, rel=1e-9)
    x = MIRROR / 2
    assert x * np.exp(x) * exp1(x) == pytest.approx(0.5, abs=1e-9)


@pytest.mark.slow
def test_scipy_finds_the_same_root():
    u = 0.3

    def mean(w):
        def inner(e):
            x = w / ((1 - u) / e + 2 * u)
            return np.exp(-e) * x * np.exp(x) * exp1(x)

        return quad(inner, 0, 60, epsabs=1e-12, limit=200)[0] - 0.5

    assert widening(u).value == pytest.approx(brentq(mean, 1, 2, xtol=1e-12), rel=1e-9)


@pytest.mark.slow
def test_equal_axes_are_one_axis_within_the_stated_error():
    shares = np.linspace(0, 1, 9)
    one = SGGX_FILTER.estimates(shares[:, None])
    two = SGGX_FILTER_AXES.estimates(np.stack([shares, shares], axis=1))
    assert np.all(np.abs(one.value - two.value) <= one.error + two.error)
    assert np.max(two.error) < 1e-5
    assert np.max(one.error) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("shares", [(0.5, 0.1), (0.0, 1.0)])
def test_a_sample_of_slopes_agrees(shares):
    exact, sampled = axis_widening(*shares), axis_widening_by_sampling(*shares, samples=1 << 14)
    assert abs(exact.value - sampled.value) < 5 * sampled.error
    assert sampled.error < 0.04


@pytest.mark.slow
def test_first_order_in_the_spread():
    step = 1e-4
    points = np.array([[0, 0], [step, 0], [0, step]])
    none, along, across = SGGX_FILTER_AXES.values(points)
    # g₁ = (1 + t₁) w₁ is 1 + 7/4 t₁ + 1/4 t₂ + O(t²). The rule's error of 1e-8 is divided by 1e-4.
    assert (along - none) / step == pytest.approx(0.75, abs=1e-3)
    assert (across - none) / step == pytest.approx(0.25, abs=1e-3)


@pytest.mark.slow
def test_the_derivative_is_that_of_the_root():
    step = 1e-5
    slope = jax.grad(lambda u: widening(u).value)(0.5)
    difference = (widening(0.5 + step).value - widening(0.5 - step).value) / (2 * step)
    assert slope == pytest.approx(float(difference), rel=1e-8)
