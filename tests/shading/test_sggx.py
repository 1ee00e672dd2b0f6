"""The SGGX distribution: normalisation, fibres as a special case, sampling."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import cubature
from scipy.stats import chi2

from shading import (
    direction,
    fiber_direction,
    fiber_matrix,
    fiber_normal_distribution,
    fiber_projected_area,
    fiber_root,
    normal_distribution,
    phase_function,
    projected_area,
    reflect,
    sample_visible_normal,
    visible_normal,
)

# The tolerance of SciPy's adaptive rule. Results are compared with ten times this tolerance.
RULE_TOLERANCE = 1e-11
# Probability that a correct sampler is rejected. The seed is fixed, so the result is reproducible.
REJECTION = 1e-4


def random_matrix(seed: int, least_axis: float = 0.2) -> np.ndarray:
    """Return an SGGX matrix with random axes whose lengths are from `least_axis` to 1."""
    rng = np.random.default_rng(seed)
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    matrix = (axes * rng.uniform(least_axis, 1, 3) ** 2) @ axes.T
    return (matrix + matrix.T) / 2


def around(axis, theta, phi):
    """Return unit vectors (n, 3) at the angles `theta` from `axis` and azimuths `phi` about it."""
    axis = np.asarray(axis)
    first = np.cross(axis, [1.0, 0, 0] if abs(axis[0]) < 0.7 else [0, 1.0, 0])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    across = np.cos(phi)[:, None] * first + np.sin(phi)[:, None] * second
    return np.cos(theta)[:, None] * axis + np.sin(theta)[:, None] * across


MATRICES = {
    "fibre 0.3": np.asarray(fiber_matrix(fiber_direction(0.9), 0.3)),
    "fibre 0.8": np.asarray(fiber_matrix(fiber_direction(0.2), 0.8)),
    "isotropic": np.eye(3),
    "general 1": random_matrix(1),
    "general 2": random_matrix(2),
}
LIGHTS = [np.asarray(direction(0.0, 0.0)), np.asarray(direction(0.9, 0.4))]
LIGHTS += [np.asarray(direction(1.57, 3.0)), np.asarray(direction(2.5, -1.0))]


PHASE = jax.jit(jax.vmap(phase_function, (None, None, 0)))
DISTRIBUTION = jax.jit(jax.vmap(normal_distribution, (None, 0)))
SAMPLE = jax.jit(jax.vmap(sample_visible_normal, (None, None, 0)))


def over_sphere(function, axis, upper):
    """Integrate over the directions within the angle `upper` of `axis` by an adaptive rule."""

    def integrand(angles):
        return function(around(axis, *angles.T)) * np.sin(angles[:, 0])

    result = cubature(integrand, [0, 0], [upper, 2 * np.pi], atol=RULE_TOLERANCE, rtol=0)
    assert result.status == "converged"
    return result.estimate


@pytest.mark.parametrize("name", MATRICES)
@pytest.mark.parametrize("light", range(len(LIGHTS)))
def test_phase_function_integrates_to_one(name, light):
    u = LIGHTS[light]
    total = over_sphere(lambda v: PHASE(MATRICES[name], u, v), u, np.pi)
    assert abs(total - 1) < 10 * RULE_TOLERANCE


@pytest.mark.parametrize("name", MATRICES)
def test_projected_area_is_the_integral_over_visible_normals(name):
    u, matrix = LIGHTS[1], MATRICES[name]
    area = over_sphere(lambda h: DISTRIBUTION(matrix, h) * (h @ u), u, np.pi / 2)
    assert abs(area - projected_area(matrix, u)) < 10 * RULE_TOLERANCE


def test_phase_function_times_projected_area_is_reciprocal():
    u, v = LIGHTS[1], LIGHTS[2]
    for matrix in MATRICES.values():
        there = phase_function(matrix, u, v) * projected_area(matrix, u)
        back = phase_function(matrix, v, u) * projected_area(matrix, v)
        np.testing.assert_allclose(there, back, rtol=1e-14)


def test_fiber_functions_equal_the_general_ones():
    rng = np.random.default_rng(3)
    for alpha, theta_f in zip(rng.uniform(0.05, 1, 20), rng.uniform(0, np.pi / 2, 20), strict=True):
        fiber, h = fiber_direction(theta_f), np.asarray(direction(*rng.uniform(0, 3, 2)))
        matrix, root = fiber_matrix(fiber, alpha), fiber_root(fiber, alpha)
        # S adds α² to numbers of order one, so a rounding of S becomes 1/α² roundings of D.
        rounding = 8 * np.finfo(float).eps / alpha**2
        np.testing.assert_allclose(root @ root.T, matrix, atol=1e-15)
        np.testing.assert_allclose(
            normal_distribution(matrix, h),
            fiber_normal_distribution(h @ fiber, alpha),
            rtol=rounding,
        )
        np.testing.assert_allclose(
            projected_area(matrix, h), fiber_projected_area(h @ fiber, alpha), rtol=rounding
        )


def test_fiber_root_keeps_a_small_alpha_exactly():
    for alpha in (1e-3, 1e-9, 1e-15):
        fiber = fiber_direction(0.0)
        assert float(fiber @ fiber_root(fiber, alpha) @ fiber) == alpha


def test_reflect_is_a_reflection():
    normals = np.random.default_rng(4).normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    u = LIGHTS[1]
    mirrored = jax.vmap(reflect, (None, 0))(u, normals)
    np.testing.assert_allclose(jnp.linalg.norm(mirrored, axis=1), 1, rtol=1e-14)
    np.testing.assert_allclose(
        jax.vmap(reflect)(mirrored, normals), jnp.tile(u, (50, 1)), atol=1e-14
    )
    np.testing.assert_allclose(jnp.sum(mirrored * normals, 1), normals @ u, atol=1e-14)


def p_value(matrix, light, normals) -> float:
    """Return the p-value: the probability that normals of this density deviate more than these.

    The bins are 12 in the cosine with the light by 16 in azimuth. The expected count of a bin is
    the integral of D(m) (u·m) / σ(u) by 8² Gauss points.
    """
    cosines, azimuths = 12, 16
    x, weights = np.polynomial.legendre.leggauss(8)
    x, weights = (x + 1) / 2, weights / 2
    cosine = ((np.arange(cosines)[:, None] + x) / cosines).ravel()
    azimuth = ((np.arange(azimuths)[:, None] + x) * 2 * np.pi / azimuths).ravel() - np.pi
    grid = np.stack(np.meshgrid(np.arccos(cosine), azimuth, indexing="ij")).reshape(2, -1)
    at = around(light, *grid)
    density = DISTRIBUTION(matrix, at) * (at @ light)
    density = np.reshape(density / projected_area(matrix, light), (cosines, 8, azimuths, 8))
    expected = np.einsum("aibj,i,j->ab", density, weights, weights) * 2 * np.pi / cosines / azimuths
    assert abs(expected.sum() - 1) < 1e-4
    first, second = around(light, np.full(2, np.pi / 2), np.array([0, np.pi / 2]))
    counts, _, _ = np.histogram2d(
        np.asarray(normals @ light),
        np.arctan2(normals @ second, normals @ first),
        [np.linspace(0, 1, cosines + 1), np.linspace(-np.pi, np.pi, azimuths + 1)],
    )
    assert counts.sum() == len(normals)
    expected *= len(normals)
    full = expected > 10
    statistic = np.sum((counts[full] - expected[full]) ** 2 / expected[full])
    return chi2.sf(statistic, full.sum() - 1)


@pytest.mark.parametrize("name", MATRICES)
@pytest.mark.parametrize("light", range(len(LIGHTS)))
def test_visible_normals_follow_their_density(name, light):
    matrix, u = MATRICES[name], LIGHTS[light]
    points = np.random.default_rng(5).random((100_000, 2))
    normals = SAMPLE(matrix, u, points)
    np.testing.assert_allclose(jnp.linalg.norm(normals, axis=1), 1, rtol=1e-14)
    assert jnp.all(normals @ u >= 0)
    assert p_value(matrix, u, normals) > REJECTION


def test_any_square_root_gives_the_same_density():
    fiber, alpha, u = fiber_direction(0.9), 0.3, LIGHTS[1]
    points = np.random.default_rng(6).random((100_000, 2))
    normals = jax.vmap(visible_normal, (None, None, 0))(fiber_root(fiber, alpha), u, points)
    assert p_value(MATRICES["fibre 0.3"], u, normals) > REJECTION


def test_a_wrong_density_is_rejected():
    wrong, u = fiber_matrix(fiber_direction(0.9), 0.32), LIGHTS[1]
    points = np.random.default_rng(5).random((100_000, 2))
    normals = SAMPLE(wrong, u, points)
    assert p_value(MATRICES["fibre 0.3"], u, normals) < 1e-9
