"""The cubic's positive root: exact for cubics of known roots, and its implicit derivative."""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals.root import at_least, positive_root
from tests.differences import difference

EPS = np.finfo(float).eps


def known_cubics(seed: int, count: int):
    """Give (roots (3, count), A/2, E/2, m) of cubics with the roots λ > 0 ≥ −r ≥ −s."""
    rng = np.random.default_rng(seed)
    root, r, s = 10 ** rng.uniform(-3, 0, (3, count))
    r, s = np.where(rng.random((2, count)) < 0.1, 0, [r, s])
    half_a = (r + s - root) / 2
    half_e = (root * (r + s) - r * s) / 2
    return (root, r, s), (half_a, half_e, root * r * s)


@functools.cache
def solver(steps: int):
    return jax.jit(jax.vmap(lambda a, e, m, start: positive_root(a, e, m, start, 0.0, steps)))


@pytest.mark.parametrize("factor", [1.0, 1.5, 10.0])
def test_it_finds_the_positive_root_from_above(factor):
    roots, coefficients = known_cubics(0, 5000)
    # A start of ten times the root takes some steps more before convergence turns quadratic.
    found = solver(12)(*coefficients, factor * roots[0])
    root, r, s = roots
    # Roundings of the coefficients, and of the quadratic's D next to its discriminant's root.
    terms = root**3 + (r + s + root) * root**2 + (root * (r + s) + r * s) * root + root * r * s
    half_d, half_b = coefficients[1] + root**2 / 2, coefficients[0] + root
    allowed = EPS * (terms / ((root + r) * (root + s)) + abs(half_d) / half_b)
    assert np.all(abs(found - root) < 4 * allowed)


def test_convergence_is_quadratic_and_monotone_from_above():
    roots, coefficients = known_cubics(1, 2000)
    errors = [
        np.asarray(solver(steps)(*coefficients, 1.3 * roots[0])) / roots[0] - 1
        for steps in (1, 2, 3)
    ]
    for before, after in itertools.pairwise(errors):
        assert np.all(after >= -1e-9)
        significant = before > 1e-5
        assert significant.any()
        assert np.all(after[significant] <= before[significant] ** 2)


def test_a_zero_constant_leaves_the_root_of_the_quadratic():
    a, e = np.array([0.3, -0.3, 0.0]), np.array([0.5, 0.5, 0.2])
    exact = -a + np.sqrt(a * a + 2 * e)
    np.testing.assert_allclose(solver(6)(a, e, np.zeros(3), 1.2 * exact), exact, rtol=4 * EPS)


def test_the_derivative_is_the_implicit_one():
    roots, coefficients = known_cubics(2, 200)
    simple = (roots[0] > 0.05) & (roots[1] + roots[2] > 0)
    points = np.stack([c[simple] for c in coefficients])
    start = 1.2 * roots[0][simple]

    def find(a, e, m, start):
        return positive_root(a, e, m, start, 0.0, 8)

    gradient = jax.jit(jax.vmap(jax.grad(find, (0, 1, 2, 3))))(*points, start)
    assert np.all(gradient[3] == 0)
    for axis in range(3):
        step = 1e-4 * roots[0][simple] * (1e-1 + abs(points[axis]))
        upper = difference(lambda p: solver(20)(*p, start), points, axis, step, -9, 9)
        # h⁴ of the stencil, and the roundings of the root over h.
        np.testing.assert_allclose(gradient[axis], upper, rtol=1e-6, atol=1e-9 / step.min() * 1e-6)


def test_a_floor_only_raises_and_keeps_the_values_own_derivative():
    x = np.array([-1.0, 0.5, 1.0, 2.0])
    np.testing.assert_array_equal(at_least(jnp.array(x), 1.0), np.maximum(x, 1))
    for value in x:
        assert jax.grad(at_least)(jnp.array(value), 1.0) == 1
        assert jax.grad(at_least, 1)(jnp.array(value), 1.0) == 0
        assert jax.jacfwd(at_least)(jnp.array(value), 1.0) == 1


def test_a_floor_keeps_the_division_finite():
    """With A/2 + λ rounded to zero and below, the floor stands in for it."""
    root = positive_root(*map(jnp.array, (-0.5, 0.0, 0.0, 0.5)), 1e-3, 3)
    assert np.isfinite(root)
