"""Derivatives of P_s: finite on the whole closed domain, equal to finite differences."""

import functools
import itertools

import jax
import numpy as np
import pytest

from integrals import PS
from integrals.fuzz.ps import sggx_scattered_fraction
from shading import direction, fiber_direction, fiber_matrix
from tests.batches import batched
from tests.integrals.differences import difference
from tests.integrals.problems import RIGHT, awkward_points

AXES = (0, 1, 2, 3)
ENDS = [(1e-50, 1.0), (0.0, RIGHT), (0.0, RIGHT), (-2 * np.pi, 2 * np.pi)]
# Near the fibre's mirror image P_s varies over an angle α² of the light. Stencils of step STEP α²
# are good to STEP⁴ and ε/STEP times a few /α², ten times less for derivatives of the gradient.
STEP, DIFFERENCES = 2e-3, 1e-10
# Enough for the quadrature at α ≥ 0.3, as its stated error says.
NODES = 128
# Two analytic derivatives share all but roundings, of values that grow like 1/α.
ROUNDINGS = 1e-12


@functools.cache
def corners(*alphas) -> np.ndarray:
    """Give (4, n): every combination of ends, of what rounds to them, and of a point inside."""
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
    """Give tuples of derivatives, nested or not, as one array of a function of points (4, n)."""
    evaluate = batched(function, width)
    return lambda points: np.stack([np.stack(row) for row in evaluate(*points)])


@pytest.mark.parametrize("mode", [jax.grad, jax.jacfwd])
def test_first_derivatives_of_the_closed_form_are_finite(mode):
    points = corners(1e-9, 1e-3, 0.02, 0.15, 0.5, 1 - 1e-9, 1.0)
    assert np.isfinite(gradient("closed_form", mode)(points)).all()


@pytest.mark.parametrize("mode", [jax.grad, pytest.param(jax.jacfwd, marks=pytest.mark.slow)])
def test_derivatives_of_quadrature_and_closed_form_agree(mode):
    """Each differentiates its own formula; they meet in every corner."""
    points = np.concatenate([corners(0.3, 1.0)[:, ::4], awkward_points(1, 60, 0.3)], axis=1)
    quadrature = gradient("quadrature", mode, nodes=NODES)
    assert np.all(abs(quadrature(points) - gradient("closed_form", jax.grad)(points)) < ROUNDINGS)


def differences(function, points):
    """Give the derivative along each axis: (axes, ..., n)."""
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


def test_second_derivatives_are_finite_and_equal_finite_differences():
    resolved = np.concatenate([corners(0.15, 1.0)[:, ::3], awkward_points(4, 300, 0.15)], axis=1)
    points = np.concatenate([resolved, corners(1e-3, 0.5)[:, ::2]], axis=1)
    second = hessian()(points)
    assert np.isfinite(second).all()
    # The largest of a point's second derivatives grows like 1/α²; its roundings reach the others.
    rounding = 8 * np.finfo(float).eps * abs(second).max(axis=(0, 1))
    asymmetry = abs(second - second.swapaxes(0, 1))
    assert np.all(asymmetry <= 1e-9 * (1 + abs(second)) + rounding)
    expected = differences(gradient("closed_form", jax.grad), resolved)
    miss = second[..., : resolved.shape[1]] - expected
    assert np.all(abs(miss) < 10 * DIFFERENCES / resolved[0] ** 3)


def test_derivatives_of_the_sggx_closed_form_are_exact():
    """The fibre's closed form differentiates another formula; directions keep their length."""
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
