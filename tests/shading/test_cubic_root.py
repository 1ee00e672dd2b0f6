"""The positive root of the cubic, compared with known roots, and its derivative."""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shading.cubic_root import at_least, magnitude, newton_step, positive_root, tangent_step
from tests.integrals.differences import difference

EPS = np.finfo(float).eps
STEPS = [newton_step, tangent_step]


def known_cubics(seed: int, count: int):
    """Return (λ, r, s) and (A, E, m) of cubics with the roots λ > 0, −r ≤ 0 and −s ≤ 0."""
    rng = np.random.default_rng(seed)
    root, r, s = 10 ** rng.uniform(-3, 0, (3, count))
    r, s = np.where(rng.random((2, count)) < 0.1, 0, [r, s])
    return (root, r, s), (r + s - root, root * (r + s) - r * s, root * r * s)


@functools.cache
def solver(step, steps: int):
    return jax.jit(jax.vmap(lambda a, e, m, start: positive_root(a, e, m, start, step, steps)))


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("factor", [1.0, 1.5, 10.0])
def test_finds_the_positive_root_from_above(factor, step):
    (root, r, s), (a, e, m) = known_cubics(0, 5000)
    # A start of ten times the root needs more steps before convergence is quadratic.
    found = solver(step, 12)(a, e, m, factor * root)
    # Roundings of the coefficients, and of d in `tangent_step`.
    terms = root**3 + (r + s + root) * root**2 + (root * (r + s) + r * s) * root + m
    allowed = EPS * (terms / ((root + r) * (root + s)) + abs(e + root**2) / (a + 2 * root))
    assert np.all(abs(found - root) < 4 * allowed)


@pytest.mark.parametrize(("step", "constant"), [(newton_step, 2), (tangent_step, 1)])
def test_convergence_is_quadratic_and_monotone_from_above(step, constant):
    roots, coefficients = known_cubics(1, 2000)
    errors = [
        np.asarray(solver(step, steps)(*coefficients, 1.3 * roots[0])) / roots[0] - 1
        for steps in range(4)
    ]
    for before, after in itertools.pairwise(errors):
        assert np.all(after >= -1e-9)
        significant = before > 1e-5
        assert significant.any()
        assert np.all(after[significant] <= constant * before[significant] ** 2)


def test_newton_from_below_is_above_the_root_after_one_step():
    """A start below the root by ε leaves an error between 0 and 2ε²/(1 − 3ε)."""
    roots, coefficients = known_cubics(3, 2000)
    for below in (0.1, 0.01):
        after = solver(newton_step, 1)(*coefficients, (1 - below) * roots[0]) / roots[0] - 1
        assert np.all(after >= -1e-9)
        assert np.all(after <= 2 * below**2 / (1 - 3 * below) + 1e-9)


@pytest.mark.parametrize("step", STEPS)
def test_without_a_constant_the_cubic_has_the_root_of_a_quadratic(step):
    a, e = np.array([0.6, -0.6, 0.0]), np.array([1.0, 1.0, 0.4])
    exact = -a / 2 + np.sqrt(a * a / 4 + e)
    found = solver(step, 6)(a, e, np.zeros(3), 1.2 * exact)
    np.testing.assert_allclose(found, exact, rtol=4 * EPS)


@pytest.mark.parametrize("step", STEPS)
def test_derivative_is_that_of_the_implicit_equation(step):
    roots, coefficients = known_cubics(2, 200)
    simple = (roots[0] > 0.05) & (roots[1] + roots[2] > 0)
    points = np.stack([c[simple] for c in coefficients])
    start = 1.2 * roots[0][simple]

    def find(a, e, m, start):
        return positive_root(a, e, m, start, step, 8)

    gradient = jax.jit(jax.vmap(jax.grad(find, (0, 1, 2, 3))))(*points, start)
    assert np.all(gradient[3] == 0)
    for axis in range(3):
        width = 1e-4 * roots[0][simple] * (1e-1 + abs(points[axis]))
        upper = difference(lambda p: solver(step, 20)(*p, start), points, axis, width, -9, 9)
        # The error of the stencil is of order h⁴, plus the roundings of the root over h.
        np.testing.assert_allclose(gradient[axis], upper, rtol=1e-6, atol=1e-9 / width.min() * 1e-6)


def test_at_least_keeps_the_derivative_of_the_value():
    x = np.array([-1.0, 0.5, 1.0, 2.0])
    np.testing.assert_array_equal(at_least(jnp.array(x), 1.0), np.maximum(x, 1))
    for value in x:
        assert jax.grad(at_least)(jnp.array(value), 1.0) == 1
        assert jax.grad(at_least, 1)(jnp.array(value), 1.0) == 0
        assert jax.jacfwd(at_least)(jnp.array(value), 1.0) == 1


def test_magnitude_keeps_the_derivative_of_the_value():
    x = np.array([-1e-30, -0.0, 0.0, 2.0])
    np.testing.assert_array_equal(magnitude(jnp.array(x)), np.abs(x))
    for value in x:
        assert jax.grad(magnitude)(jnp.array(value)) == 1
        assert jax.jacfwd(magnitude)(jnp.array(value)) == 1
