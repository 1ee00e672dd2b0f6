"""Derivatives of P_s are finite on the closed domain and equal finite differences."""

import functools
import itertools

import jax
import numpy as np
import pytest

from integrals import PS
from integrals.fuzz.sggx import sggx_scattered_fraction
from shading import direction, fiber_direction, fiber_matrix
from tests.batches import batched
from tests.integrals.differences import difference
from tests.integrals.problems import RIGHT, awkward_points

AXES = (0, 1, 2, 3)
ENDS = [(1e-50, 1.0), (0.0, RIGHT), (0.0, RIGHT), (-2 * np.pi, 2 * np.pi)]
# Near the mirror image of the fibre, P_s changes over an angle of α² of the light. A stencil with
# the step STEP α² has errors of a few STEP⁴/α² and ε/(STEP α²). For derivatives of the gradient
# they are ten times as large.
STEP, DIFFERENCES = 2e-3, 1e-10
# Enough nodes for the quadrature at α ≥ 0.3, according to its stated error.
NODES = 128
# Two analytic derivatives differ by roundings only. Their values grow like 1/α.
ROUNDINGS = 1e-12


@functools.cache
def corners(*alphas) -> np.ndarray:
    """Return points (4, n): all combinations of ends, values close to them, and one inside."""
    angles = [0.0, 1e-12, 1e-6, 0.7, RIGHT - 1e-6, RIGHT]
    azimuths = [0.0, 1e-9, 0.5, RIGHT, np.pi, -np.pi, 2 * np.pi]
    return np.array(list(itertools.product(alphas, angles, angles, azimuths))).T


@functools.cache
def gradient(leg, mode, **options):
    def value(*x):
        return PS.legs[leg](*x, **options).value

    return stacked(mode(value, AXES), 8 if leg == "quadrature" else 256)


@functools.cache
def closed_form():
    evaluate = batched(PS.closed_form, 256)
    return lambda points: evaluate(*points).value


@functools.cache
def hessian():
    return stacked(jax.hessian(lambda *x: PS.closed_form(*x).value, AXES), 256)


def stacked(function, width):
    """Return a function of points (4, n) whose (nested) tuple of derivatives is one array."""
    evaluate = batched(function, width)
    return lambda points: np.stack([np.stack(row) for row in evaluate(*points)])


@pytest.mark.parametrize("mode", [jax.grad, jax.jacfwd])
def test_first_derivatives_of_the_closed_form_are_finite(mode):
    points = corners(1e-9, 1e-3, 0.02, 0.15, 0.5, 1 - 1e-9, 1.0)
    assert np.isfinite(gradient("closed_form", mode)(points)).all()


@pytest.mark.parametrize("mode", [jax.grad, pytest.param(jax.jacfwd, marks=pytest.mark.slow)])
def test_derivatives_of_quadrature_and_closed_form_agree(mode):
    """Each leg differentiates its own formula. They agree even in the corners of the domain."""
    points = np.concatenate([corners(0.3, 1.0)[:, ::4], awkward_points(1, 60, 0.3)], axis=1)
    quadrature = gradient("quadrature", mode, nodes=NODES)
    assert np.all(abs(quadrature(points) - gradient("closed_form", jax.grad)(points)) < ROUNDINGS)


def differences(function, points):
    """Return the derivatives along all axes, (axes, ..., n)."""
    return np.stack(
        [
            difference(function, points, axis, STEP * points[0] ** 2, *ENDS[axis])
            for axis in range(len(points))
        ]
    )


def test_first_derivatives_equal_finite_differences():
    points = np.concatenate([corners(0.15, 0.5, 1.0), awkward_points(2, 2000, 0.15)], axis=1)
    miss = gradient("closed_form", jax.grad)(points) - differences(closed_form(), points)
    assert np.all(abs(miss) < DIFFERENCES / points[0] ** 2)


def test_first_derivatives_of_the_quadrature_equal_finite_differences():
    points = np.concatenate([corners(0.3, 1.0)[:, ::29], awkward_points(3, 14, 0.3)], axis=1)
    evaluate = batched(functools.partial(PS.quadrature, nodes=NODES), 8)
    expected = differences(lambda points: evaluate(*points).value, points)
    miss = gradient("quadrature", jax.grad, nodes=NODES)(points) - expected
    assert np.all(abs(miss) < DIFFERENCES / points[0] ** 2)


@pytest.mark.slow
def test_second_derivatives_are_finite_and_equal_finite_differences():
    resolved = np.concatenate([corners(0.15, 1.0)[:, ::3], awkward_points(4, 300, 0.15)], axis=1)
    points = np.concatenate([resolved, corners(1e-3, 0.5)[:, ::2]], axis=1)
    second = hessian()(points)
    assert np.isfinite(second).all()
    # The largest second derivative at a point grows like 1/α². Its roundings affect the others.
    rounding = 8 * np.finfo(float).eps * abs(second).max(axis=(0, 1))
    asymmetry = abs(second - second.swapaxes(0, 1))
    assert np.all(asymmetry <= 1e-9 * (1 + abs(second)) + rounding)
    expected = differences(gradient("closed_form", jax.grad), resolved)
    miss = second[..., : resolved.shape[1]] - expected
    assert np.all(abs(miss) < 10 * DIFFERENCES / resolved[0] ** 3)


@pytest.mark.slow
def test_derivatives_of_the_sggx_closed_form_are_exact():
    """Compared with the closed form for fibres, which is another formula."""
    points = corners(0.15, 0.5, 1.0)

    def general(alpha, theta_f, theta_u, phi):
        matrix = fiber_matrix(fiber_direction(theta_f), alpha)
        return sggx_scattered_fraction(matrix, direction(theta_u, phi))

    derivatives = stacked(jax.grad(general, AXES), 256)(points)
    expected = gradient("closed_form", jax.grad)(points)
    np.testing.assert_allclose(derivatives, expected, rtol=0, atol=1e-11)


def test_monte_carlo_has_no_derivative():
    def count(alpha):
        return PS.monte_carlo(alpha, 0.5, 0.5, 0.5, samples=64).value

    for mode in (jax.grad, jax.jacfwd, jax.jacrev):
        with pytest.raises(TypeError, match="no derivative"):
            jax.jit(mode(count))(0.5)
