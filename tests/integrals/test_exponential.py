"""Exponential integrals have full relative precision, compared with mpmath."""

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest

from integrals.special.exponential import e1, e2, e3, ein, gamma2

# Near x = 2 the series of Ein and γ + ln x cancel: E₁ loses a factor of 30, and E₃ of 60.
SERIES_CANCELLATION = 2e-14
# A sum of 26 terms without cancellation.
ROUNDING = 2e-15

FUNCTIONS = {
    "e1": (e1, mp.e1, SERIES_CANCELLATION),
    "e2": (e2, lambda x: mp.expint(2, x), SERIES_CANCELLATION),
    "e3": (e3, lambda x: mp.expint(3, x), SERIES_CANCELLATION),
    "ein": (ein, lambda x: mp.e1(x) + mp.log(x) + mp.euler, ROUNDING),
    "gamma2": (gamma2, lambda x: mp.gammainc(2, 0, x), ROUNDING),
}
UPPER = {"ein": 2.0, "gamma2": 1.0}


def arguments(upper: float) -> np.ndarray:
    rng = np.random.default_rng(0)
    spread = np.concatenate([10 ** rng.uniform(-12, np.log10(700), 600), rng.uniform(0, 8, 600)])
    ends = [np.nextafter(2, 0), 2.0, np.nextafter(2, 3), 1.0, 700.0]
    points = np.concatenate([spread, ends])
    return points[points <= upper]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_relative_precision_over_the_whole_range(name):
    function, oracle, tolerance = FUNCTIONS[name]
    x = arguments(UPPER.get(name, np.inf))
    with mp.workdps(40):
        exact = [oracle(mp.mpf(float(value))) for value in x]
        ratio = zip(np.asarray(jax.jit(jax.vmap(function))(x)), exact, strict=True)
        worst = max(abs(mp.mpf(float(value)) / truth - 1) for value, truth in ratio)
    assert worst < tolerance


def test_values_at_zero():
    assert e1(0.0) == np.inf
    assert e2(0.0) == 1
    assert e3(0.0) == 0.5
    assert ein(0.0) == 0
    assert gamma2(0.0) == 0


@pytest.mark.parametrize("function", [e1, e2, e3])
def test_values_are_zero_for_large_arguments(function):
    assert function(1e4) == 0
    assert function(1e300) == 0
    assert jax.grad(function)(1e300) == 0


def test_derivatives_are_the_integrals_of_one_order_less():
    x = jnp.array([1e-9, 0.3, 1.999, 2.001, 50.0])
    value1, value2 = jax.vmap(e1)(x), jax.vmap(e2)(x)
    for derivative, expected in (
        (jax.grad(e1), -np.exp(-x) / x),
        (jax.grad(e2), -value1),
        (jax.grad(e3), -value2),
        (jax.jacfwd(e3), -value2),
        (jax.grad(jax.grad(e3)), value1),
    ):
        actual = jax.jit(jax.vmap(derivative))(x)
        np.testing.assert_allclose(actual, expected, rtol=SERIES_CANCELLATION)


def test_derivatives_at_zero():
    assert jax.grad(e3)(0.0) == -1
    assert jax.grad(e2)(0.0) == -np.inf
