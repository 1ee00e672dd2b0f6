"""R: its quadrature is compared with nested quadrature of the definition and with Monte Carlo."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals import PS, R
from integrals.fuzz.r import average_over_lights
from tests.batches import batched
from tests.integrals.differences import difference
from tests.integrals.problems import RIGHT, upright_average

EPS = np.finfo(float).eps
# Enough nodes for derivatives at α ≥ 0.15.
NODES = 24


@functools.cache
def quadrature(**options):
    return batched(functools.partial(R.quadrature, **options), 8)


@functools.cache
def gradient(mode):
    def value(alpha, theta_f):
        return R.quadrature(alpha, theta_f, nodes=NODES).value

    return batched(mode(value, (0, 1)), 8)


def points(seed, count, least_alpha) -> np.ndarray:
    rng = np.random.default_rng(seed)
    alpha = np.exp(rng.uniform(np.log(least_alpha), 0, count))
    near = 10 ** rng.uniform(-6, 0, count)
    theta = np.choose(
        rng.integers(0, 4, count), (near, 1 - near, rng.random(count), rng.integers(0, 2, count))
    )
    return np.stack([alpha, RIGHT * theta])


def test_upright_fibre_equals_its_closed_form():
    """Over all α: R = atan2(s (1 + α²), 1 + α² + 2α⁴)/s with s = 2α √(1 − α²)."""
    alpha = np.append(np.exp(np.random.default_rng(0).uniform(np.log(1e-3), 0, 47)), 1.0)
    value, error = quadrature()(alpha, np.zeros_like(alpha))
    exact = np.array([upright_average(a) for a in alpha])
    assert np.all(abs(value - exact) <= error + 2 * EPS)
    np.testing.assert_allclose(value[alpha > 0.15], exact[alpha > 0.15], rtol=4 * EPS)


@pytest.mark.parametrize("nodes", [24, 96])
def test_quadrature_is_within_its_stated_error(nodes):
    sample = np.concatenate([points(1, 16, least) for least in (0.15, 0.02, 1e-3)], axis=1)
    value, error = quadrature(nodes=nodes)(*sample)
    truth, finer = quadrature(nodes=320)(*sample)
    assert np.all(abs(value - truth) <= error + finer)
    # The finer rule must be much better than the tested one, up to roundings.
    assert np.all(finer <= 0.25 * error + 1e-12)


def test_stated_error_is_small():
    _, error = quadrature()(*points(2, 24, 0.15))
    assert np.all(error < 1e-12)


def test_values_at_many_points_are_exact_to_2e_8():
    """`R.values` uses fewer nodes for α ≥ 0.15. The least α is the hardest."""
    hardest = np.array([(0.15, theta) for theta in np.linspace(0, RIGHT, 17)])
    assert R.options_at(hardest) == {"nodes": 32}
    exact = quadrature(nodes=160)(*hardest.T).value
    np.testing.assert_allclose(R.values(hardest), exact, rtol=0, atol=2e-8)
    lower = np.concatenate([hardest, [(0.1, 0.7)]])
    assert R.options_at(lower) == {"nodes": 96}
    np.testing.assert_allclose(R.values(lower)[:-1], exact, rtol=0, atol=1e-13)


@pytest.mark.parametrize("point", [(0.4, 0.7)])
def test_agrees_with_nested_quadrature_of_the_definition(point):
    """Average the quadrature of P_s, so that no closed form is used."""
    alpha, theta_f = point

    def fraction(theta_u, phi):
        return PS.quadrature(alpha, theta_f, theta_u, phi, nodes=48).value

    def rule(nodes):
        cosines, weights = np.polynomial.legendre.leggauss(nodes)
        theta_u = np.arccos((cosines + 1) / 2)
        phi = (np.arange(nodes) + 0.5) * np.pi / nodes
        grid = np.stack(np.meshgrid(theta_u, phi, indexing="ij")).reshape(2, -1)
        values = inner(*grid).reshape(nodes, nodes).mean(axis=1)
        return float(np.sum(weights * (cosines + 1) / 2 * values))

    inner = jax.jit(lambda *x: jax.lax.map(lambda x: fraction(*x), x, batch_size=32))
    fine, coarse = rule(20), rule(16)
    value, error = quadrature()(np.array([alpha]), np.array([theta_f]))
    assert abs(fine - coarse) < 1e-6
    assert abs(value[0] - fine) <= abs(fine - coarse) + error[0] + 1e-14


@pytest.mark.parametrize("sequence", ["random", "sobol"])
def test_monte_carlo_is_within_five_standard_errors(sequence):
    sample = points(3, 12, 0.02)
    one = functools.partial(R.monte_carlo, sequence=sequence)
    value, error = jax.jit(jax.vmap(one))(*sample)
    truth, allowance = quadrature()(*sample)
    assert np.all(abs(value - truth) <= 5 * error + allowance)
    assert np.all(error < 5e-3)


def test_average_over_lights_is_exact_for_powers_of_the_cosine():
    """∫ (u·n)^k cos²φ (u·n) dω_u / π = 1/(k + 2)."""
    for power in (0, 1, 5):
        value = average_over_lights(
            lambda theta, phi, power=power: jnp.cos(theta) ** power * jnp.cos(phi) ** 2, 8
        )
        np.testing.assert_allclose(value, 1 / (power + 2), rtol=32 * EPS)


def corners() -> np.ndarray:
    ends = [0.0, 1e-12, 1e-6, 0.7, RIGHT - 1e-6, RIGHT]
    return np.array([(alpha, theta) for alpha in (0.15, 0.5, 1.0) for theta in ends]).T


def test_derivatives_are_finite_and_equal_finite_differences():
    sample = np.concatenate([corners(), points(4, 22, 0.15)], axis=1)
    derivatives = gradient(jax.grad)(*sample)
    forward = gradient(jax.jacfwd)(*sample)
    np.testing.assert_allclose(forward, derivatives, rtol=0, atol=1e-12)

    def value(x):
        return quadrature(nodes=NODES)(*x).value

    # The error is of fourth order in step/α, plus roundings over the step.
    step = 1e-3 * sample[0]
    for axis, ends in enumerate([(1e-3, 1.0), (0.0, RIGHT)]):
        expected = difference(value, sample, axis, step, *ends)
        assert np.all(abs(derivatives[axis] - expected) < 1e-10 / sample[0])


def test_derivatives_are_finite_for_small_alpha():
    sample = np.concatenate([corners()[:, :6] * [[1e-3], [1.0]], [[1e-9], [0.7]]], axis=1)
    assert np.isfinite(gradient(jax.grad)(*sample)).all()


def test_slope_is_zero_for_upright_and_lying_fibres():
    alpha = np.array([0.15, 0.5, 0.15, 0.5])
    slope = gradient(jax.grad)(alpha, np.array([0.0, 0.0, RIGHT, RIGHT]))[1]
    np.testing.assert_allclose(slope, 0, atol=1e-13)


@pytest.mark.slow
def test_second_derivatives_are_finite():
    def value(x):
        return R.quadrature(x[0], x[1], nodes=NODES).value

    second = jax.jit(jax.vmap(jax.hessian(value)))(corners()[:, ::5].T)
    assert np.isfinite(second).all()
    np.testing.assert_allclose(second, second.swapaxes(1, 2), rtol=1e-10, atol=1e-10)


def test_monte_carlo_has_no_derivative():
    def count(alpha):
        return R.monte_carlo(alpha, 0.5, samples=64).value

    for mode in (jax.grad, jax.jacfwd):
        with pytest.raises(TypeError, match="no derivative"):
            jax.jit(mode(count))(0.5)
