"""Q = 2 E₃(d): every leg is exact, and the slope at d = 0 is −2."""

import functools

import jax
import mpmath as mp
import numpy as np
import pytest

from integrals import Q
from integrals.fuzz.q import average_penetration
from tests.integrals.differences import difference
from tests.integrals.problems import distance, exact_q

# The series of E₃ loses a factor of 60 near d = 2 (tests/integrals/test_exponential.py).
RELATIVE = 2e-14
LEGS = ("closed_form", "quadrature", "monte_carlo")


def densities() -> np.ndarray:
    rng = np.random.default_rng(0)
    return np.concatenate([10 ** rng.uniform(-12, 2.8, 400), rng.uniform(0, 4, 300), [2.0, 700.0]])


@functools.cache
def exact():
    return [exact_q(d) for d in densities()]


@functools.cache
def evaluator(leg):
    return jax.jit(jax.vmap(Q.legs[leg]))


@functools.cache
def derivative(leg, mode=jax.grad):
    return jax.jit(jax.vmap(mode(lambda d: Q.legs[leg](d).value)))


@pytest.mark.parametrize("leg", ["closed_form", "quadrature"])
def test_each_leg_is_within_its_stated_error(leg):
    value, error = evaluator(leg)(densities())
    assert np.all(distance(value, exact()) <= error)
    assert np.all(error < 1e-13)


def test_closed_form_has_full_relative_precision():
    value = jax.jit(jax.vmap(average_penetration))(densities())
    assert np.all(distance(value, exact()) <= RELATIVE * np.array(exact()).astype(float))


def test_stated_error_holds_for_a_coarse_quadrature():
    for step in (1 / 2, 1 / 3, 1 / 4):
        value, error = jax.jit(jax.vmap(functools.partial(Q.quadrature, step=step)))(densities())
        miss = distance(value, exact())
        assert miss.max() > 1e-7
        assert np.all(miss <= error)


@pytest.mark.parametrize("sequence", ["random", "sobol"])
def test_monte_carlo_is_within_five_standard_errors(sequence):
    sample = densities()[::30]
    value, error = jax.jit(jax.vmap(functools.partial(Q.monte_carlo, sequence=sequence)))(sample)
    assert np.all(distance(value, exact()[::30]) <= 5 * error + 1e-14)


@pytest.mark.parametrize("leg", LEGS)
@pytest.mark.parametrize("mode", [jax.grad, jax.jacfwd])
def test_derivatives_are_finite_on_the_closed_domain(leg, mode):
    assert np.isfinite(derivative(leg, mode)(np.array([0, 1e-300, 1e-9, 1, 700, 1e9, 1e300]))).all()


def test_slope_at_zero_density_is_minus_two():
    assert derivative("closed_form")(np.zeros(1))[0] == -2
    np.testing.assert_allclose(derivative("quadrature")(np.zeros(1)), -2, rtol=1e-14)


@pytest.mark.parametrize("leg", LEGS)
def test_derivatives_equal_finite_differences(leg):
    d = np.concatenate([10 ** np.random.default_rng(1).uniform(-4, 1, 100), [0.0]])

    def value(x):
        return evaluator(leg)(x[0]).value

    # At d = 0 the second derivative is logarithmic, so the error of the stencil is of order h ln h.
    step = np.where(d > 0, 1e-3 * d, 1e-6)
    expected = difference(value, d[None], 0, step, 0.0, np.inf)
    rounding = np.finfo(float).eps / step
    assert np.all(abs(derivative(leg)(d) - expected) <= np.where(d > 0, 1e-9, 1e-4) + 9 * rounding)


def test_derivative_is_exact():
    d = densities()
    value = derivative("closed_form")(d)
    truth = [-2 * mp.expint(2, mp.mpf(float(x))) for x in d]
    assert np.all(distance(value, truth) <= RELATIVE * abs(np.array(truth).astype(float)))


def test_second_derivative_is_logarithmic_at_zero_density():
    """Q'' = 2 E₁(d) is finite for d > 0 and +∞ at d = 0."""
    second = jax.jit(jax.vmap(jax.grad(jax.grad(lambda d: Q.closed_form(d).value))))
    d = np.array([1e-9, 0.1, 1.0, 5.0])
    np.testing.assert_allclose(second(d), [2 * float(mp.e1(x)) for x in d], rtol=RELATIVE)
    assert second(np.zeros(1))[0] == np.inf
