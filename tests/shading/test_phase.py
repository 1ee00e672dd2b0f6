"""Phase functions: normalisation, direction of scattering, derivatives."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import cubature

from integrals import VELVET
from integrals.fuzz.velvet import scattered_energy
from shading import (
    direction,
    fiber_direction,
    fiber_matrix,
    fiber_phase_function,
    half_vector,
    phase_function,
    schlick_phase_function,
    velvet_lobe,
    velvet_phase_function,
)

FIBER = np.asarray(fiber_direction(0.6))
# The kink of the velvet lobe costs the adaptive rule some digits.
KINK_TOLERANCE = 1e-8


def over_sphere(function):
    """Integrate a function of unit vectors (n, 3) over the sphere by an adaptive rule."""

    def integrand(angles):
        return function(directions(*angles.T)) * np.sin(angles[:, 0])

    result = cubature(integrand, [0, 0], [np.pi, 2 * np.pi], atol=KINK_TOLERANCE / 10, rtol=0)
    assert result.status == "converged"
    return float(result.estimate)


directions = jax.jit(jax.vmap(direction))
LOBES = jax.jit(jax.vmap(velvet_lobe))


@pytest.mark.parametrize("asymmetry", [-0.9, -0.3, 0.0, 0.5])
def test_schlick_phase_function_integrates_to_one(asymmetry):
    def over_cosines(nodes):
        cosines, weights = np.polynomial.legendre.leggauss(nodes)
        values = jax.vmap(schlick_phase_function, (None, 0))(asymmetry, cosines)
        return 2 * np.pi * float(np.sum(weights * values))

    np.testing.assert_allclose(over_cosines(200), 1, rtol=1e-13)


def test_positive_asymmetry_scatters_forward():
    for asymmetry in (-0.6, 0.6):
        ahead, behind = (schlick_phase_function(asymmetry, c) for c in (1.0, -1.0))
        assert (ahead > behind) == (asymmetry > 0)


@pytest.mark.slow
@pytest.mark.parametrize(("asymmetry", "theta"), [(-0.7, 0.0), (-0.7, 0.9)])
def test_velvet_lobe_integrates_to_scattered_energy(asymmetry, theta):
    """Compare the integral over v, as defined, with the one over h."""
    light = np.asarray(direction(theta + 0.6, 0.0))  # at the angle `theta` from the fibre
    phase = jax.jit(jax.vmap(lambda v: velvet_lobe(asymmetry, half_vector(light, v) @ FIBER)))
    total = over_sphere(phase)
    assert abs(total - scattered_energy(asymmetry, np.cos(theta))) < KINK_TOLERANCE


def test_velvet_lobe_scatters_back_and_across_the_fibre():
    along, across = velvet_lobe(-0.5, 1.0), velvet_lobe(-0.5, 0.0)
    np.testing.assert_allclose(across / along, 1 / (1 - 0.5) ** 2, rtol=1e-15)
    light = direction(1.2, 0.0)
    upright = direction(0.0, 0.0)
    backwards = velvet_lobe(-0.5, half_vector(light, light) @ upright)
    mirrored = velvet_lobe(-0.5, half_vector(light, direction(1.2, np.pi)) @ upright)
    assert backwards > 2 * mirrored


def test_velvet_with_zero_asymmetry_is_uniform():
    value = velvet_phase_function(0.0, 0.3, VELVET.value(0.0))
    np.testing.assert_allclose(value, 1 / (4 * np.pi), rtol=1e-15)


@pytest.mark.slow
def test_fiber_phase_function_equals_the_general_one():
    rng = np.random.default_rng(0)
    for alpha in rng.uniform(0.1, 1, 3):
        light, view = (np.asarray(direction(*rng.uniform(0, 3, 2))) for _ in range(2))
        general = phase_function(fiber_matrix(FIBER, alpha), light, view)
        np.testing.assert_allclose(
            fiber_phase_function(light, view, FIBER, alpha), general, rtol=1e-12 / alpha**2
        )


def test_velvet_lobe_derivatives_are_finite_at_the_kink():
    gradient = jax.jit(jax.vmap(jax.grad(velvet_lobe, (0, 1))))
    cosines = jnp.array([-1.0, -1 + 1e-12, 0.0, 0.4, 1 - 1e-12, 1.0])
    for asymmetry in (0.0, -0.5, -0.999):
        assert np.isfinite(gradient(jnp.full(6, asymmetry), cosines)).all()
    step = 1e-6
    upper, lower = LOBES(np.array([-0.5 + step, -0.5 - step]), np.array([0.4, 0.4]))
    slope = gradient(jnp.array([-0.5]), jnp.array([0.4]))[0]
    np.testing.assert_allclose(slope, (upper - lower) / (2 * step), rtol=1e-8)


@pytest.mark.slow
def test_fiber_phase_function_derivatives_are_finite():
    light, view = direction(0.5, 0.3), direction(1.2, 2.0)
    matrix = jax.jit(jax.jacfwd(fiber_phase_function, (0, 1, 2, 3)))(
        light, view, jnp.asarray(FIBER), 0.3
    )
    assert all(np.isfinite(part).all() for part in matrix)
