"""The reciprocal phase function of a fibre: symmetry, energy, limits, and its constants."""

import jax
import numpy as np
import pytest
from scipy.optimize import linprog

from integrals.fuzz.phase_scale import reciprocal_energy, scale_by_cosines
from shading import (
    fiber_normal_distribution,
    fiber_phase_function,
    fiber_projected_area,
    half_vector,
    reciprocal_phase_function,
    reciprocal_scale,
)
from shading.fuzz import phase

COSINES = np.linspace(0, 1, 33)
ROUGHNESSES = (0.05, 0.1, 0.2236, 0.447, 0.7071, 0.9)
# The largest relative error of the fit is 0.0134.
BOUND = 0.0135

scales = jax.jit(jax.vmap(reciprocal_scale, (0, None)))


def fitted(alpha):
    """Return s of the fit as a function of arrays."""
    return lambda cos_t: np.asarray(scales(np.asarray(cos_t), alpha))


@pytest.mark.parametrize("alpha", ROUGHNESSES)
def test_scale_is_near_the_exact_one(alpha):
    exact = scale_by_cosines(alpha)(COSINES)
    error = np.abs(scales(COSINES, alpha) / exact - 1).max()
    assert error < BOUND
    # √σ, which makes the function symmetric but does not conserve energy, has a larger error.
    root = np.sqrt(np.sqrt(1 - (1 - alpha**2) * COSINES**2))
    assert np.abs(root / exact - 1).max() > 2 * error


@pytest.mark.parametrize("alpha", ROUGHNESSES)
def test_energy(alpha):
    for cosine in (0.0, -0.6, 0.95, 1.0):
        energy = reciprocal_energy(alpha, cosine, fitted(alpha))
        assert 0.977 < energy < 1.018


def test_value_and_symmetry():
    rng = np.random.default_rng(4)
    u, v, t = (each / np.linalg.norm(each) for each in rng.normal(size=(3, 3)))
    alpha = 0.3
    value = reciprocal_phase_function(u, v, t, alpha)
    np.testing.assert_allclose(reciprocal_phase_function(v, u, -t, alpha), value, rtol=1e-14)
    density = fiber_normal_distribution(half_vector(u, v) @ t, alpha)
    expected = density / (4 * reciprocal_scale(u @ t, alpha) * reciprocal_scale(v @ t, alpha))
    np.testing.assert_allclose(value, expected, rtol=1e-14)
    # The talk's function is not symmetric for the same directions.
    one, other = fiber_phase_function(u, v, t, alpha), fiber_phase_function(v, u, t, alpha)
    assert abs(one / other - 1) > 0.1
    areas = fiber_projected_area(u @ t, alpha) / fiber_projected_area(v @ t, alpha)
    np.testing.assert_allclose(one * areas, other, rtol=1e-14)


def test_limits():
    np.testing.assert_allclose(scales(COSINES, 1.0), 1, rtol=1e-15)
    inner = COSINES[:-1]
    root = np.sqrt(np.sqrt(1 - inner**2))
    np.testing.assert_allclose(scales(inner, 1e-7), root, rtol=1e-6)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_finite_and_positive(dtype):
    for alpha in (1e-3, 0.05, 1.0):
        value = scales(np.linspace(-1, 1, 41).astype(dtype), dtype(alpha))
        assert value.dtype == dtype
        assert np.all(np.isfinite(value))
        assert np.all(value > 0)


@pytest.mark.slow
def test_constants_have_the_least_largest_error():
    """They minimise the largest relative error of s⁻⁴ on a grid, but for their rounding."""
    rows, limits = [], []
    for alpha in np.linspace(0.05, 1, 39)[:-1]:
        cosines = np.sin(np.linspace(0, np.pi / 2, 40))
        area2 = 1 - (1 - alpha**2) * cosines**2
        ratio, one = alpha**2 / area2, np.ones(len(cosines))
        terms = [ratio, ratio**2, alpha * one, alpha * ratio, alpha**2 * one]
        exact = scale_by_cosines(alpha)(cosines) ** 4 / area2
        rows.append((1 - alpha) * np.stack(terms, axis=1) * exact[:, None])
        limits.append(1 - exact)
    matrix, limit = np.concatenate(rows), np.concatenate(limits)
    slack = -np.ones((len(limit), 1))
    solved = linprog(
        [0, 0, 0, 0, 0, 1],
        np.block([[matrix, slack], [-matrix, slack]]),
        np.concatenate([limit, -limit]),
        bounds=[(None, None)] * 5 + [(0, None)],
    )
    assert solved.success
    stated = np.abs(matrix @ phase._SCALE - limit).max()
    assert solved.x[-1] <= stated < 1.03 * solved.x[-1]
