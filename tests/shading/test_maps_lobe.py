"""Lobes about mapped normals: frames, SGGX matrices, and the way back, one texel at a time."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shading import normal_distribution, projected_area
from shading.maps.extraction import limited, lobe_normal, lobe_of_matrix, squared_widths, tangent
from shading.maps.frame import normal_frame, reoriented_normal
from shading.maps.lobe import (
    lobe_brdf,
    lobe_masking,
    lobe_matrix,
    lobe_ndf,
    lobe_projected_roughness,
    matrix_of_slopes,
    roughness_matrix,
    slope_moments,
)
from shading.microfacet import ggx

K = np.array([0.0, 0.0, 1.0])
# Rounding of a few operations on numbers of the order of one.
ROUNDING = 1e-14


def unit(*vector: float) -> np.ndarray:
    return np.array(vector) / np.linalg.norm(vector)


NORMALS = [unit(0, 0, 1.0), unit(0.3, -0.2, 1.0), unit(-0.7, 0.5, 1.0)]
ROUGHNESS = [(0.3, 0.3, 0.0), (0.5, 0.1, 0.4), (0.2, 0.6, -1.1)]


@pytest.mark.parametrize("normal", NORMALS)
def test_the_frame_is_the_rotation_by_the_shortest_arc(normal):
    frame = np.asarray(normal_frame(normal))
    assert np.allclose(frame @ frame.T, np.eye(3), rtol=0, atol=ROUNDING)
    assert np.linalg.det(frame) == pytest.approx(1, abs=ROUNDING)
    assert np.array_equal(frame @ K, normal)
    # The angle of the rotation, from its trace, is that between k and n.
    assert (np.trace(frame) - 1) / 2 == pytest.approx(normal[2], abs=ROUNDING)


def test_the_frame_reorients_normals():
    base, detail = NORMALS[1], NORMALS[2]
    t, u = base + K, detail * [-1, -1, 1]
    # Barré-Brisebois and Hill: r = t (t·u)/t_z − u
    expected = t * (t @ u) / t[2] - u
    assert np.allclose(reoriented_normal(base, detail), expected, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("normal", NORMALS)
@pytest.mark.parametrize("widths", ROUGHNESS)
def test_density_and_area_need_no_eigenvectors(normal, widths):
    roughness = roughness_matrix(*widths)
    matrix, frame = lobe_matrix(normal, roughness), np.asarray(normal_frame(normal))
    for direction in (unit(0.1, 0.2, 1.0), unit(-0.9, 0.3, 0.4)):
        world = frame @ direction
        expected = normal_distribution(matrix, world)
        assert lobe_ndf(direction, roughness) == pytest.approx(float(expected), rel=2e-12)
        area = projected_area(matrix, world)
        assert lobe_projected_roughness(direction, roughness) == pytest.approx(float(area))


def test_along_the_axes_a_lobe_is_that_of_ggx():
    roughness, alpha = roughness_matrix(0.5, 0.2, 0.0), jnp.array([0.5, 0.2])
    view, light = unit(0.2, 0.5, 1.0), unit(-0.6, 0.1, 1.0)
    assert lobe_ndf(view, roughness) == pytest.approx(float(ggx.ndf(view, alpha)), rel=1e-13)
    assert lobe_masking(view, roughness) == pytest.approx(float(ggx.masking(view, alpha)))
    expected = float(ggx.brdf(view, light, alpha))
    assert lobe_brdf(view, light, roughness) == pytest.approx(expected, rel=1e-13)
    assert lobe_brdf(view, -light, roughness) == 0


@pytest.mark.parametrize("normal", NORMALS)
@pytest.mark.parametrize("widths", ROUGHNESS)
def test_a_lobe_comes_back_from_its_matrix(normal, widths):
    roughness = roughness_matrix(*widths)
    found, again = lobe_of_matrix(3 * lobe_matrix(normal, roughness))
    assert np.allclose(found, normal, rtol=0, atol=1e-13)
    assert np.allclose(again, roughness, rtol=0, atol=1e-13)
    along, across = squared_widths(again)
    wide, narrow = max(widths[:2]), min(widths[:2])
    assert (float(along), float(across)) == pytest.approx((wide**2, narrow**2), rel=1e-11)
    t = np.asarray(tangent(again))
    assert np.linalg.norm(t) == pytest.approx(1, abs=ROUNDING)
    if wide > narrow:
        xx, xy, yy = again
        assert np.allclose(np.array([[xx, xy], [xy, yy]]) @ t, wide**2 * t, atol=1e-12)


def test_a_matrix_over_its_last_element_has_the_moments_of_slopes():
    matrix = lobe_matrix(NORMALS[2], roughness_matrix(0.5, 0.1, 0.4))
    mean, spread = slope_moments(matrix)
    scaled = np.asarray(matrix / matrix[2, 2])
    assert np.allclose(matrix_of_slopes(mean, spread), scaled, rtol=0, atol=2e-16)
    # The density of slopes, D (h·k) dω/√S₃₃, is that t-distribution.
    slope = np.array([0.3, -0.8])
    half = unit(*slope, 1.0)
    away = slope - np.asarray(mean)
    q = away @ np.linalg.inv(spread) @ away
    density = 1 / (np.pi * np.sqrt(np.linalg.det(spread)) * (1 + q) ** 2)
    expected = normal_distribution(matrix, half) * half[2] ** 4 / np.sqrt(matrix[2, 2])
    assert density == pytest.approx(float(expected), rel=1e-12)


def test_in_a_steep_groove_the_normal_is_not_the_largest_axis():
    sides = [unit(s, 0, 0.9) for s in (-1.0, 1.0)]
    matrix = sum(lobe_matrix(n, roughness_matrix(0.1, 0.1, 0.0)) for n in sides)
    assert np.linalg.eigvalsh(matrix).argmax() == 2 and matrix[0, 0] > matrix[2, 2]
    normal, roughness = lobe_of_matrix(matrix)
    assert np.allclose(normal, K, atol=1e-15)
    assert float(squared_widths(roughness)[0]) == pytest.approx(1)


def test_one_steep_lobe_keeps_its_normal():
    normal = unit(1.5, 0, 1.0)
    found, _ = lobe_of_matrix(lobe_matrix(normal, roughness_matrix(0.3, 0.2, 0.5)))
    assert np.allclose(found, normal, atol=1e-13)


def test_widths_are_limited_and_axes_stay():
    wide = roughness_matrix(1.5, 0.5, 0.7)
    assert np.allclose(limited(wide), roughness_matrix(1.0, 0.5, 0.7), atol=1e-14)


@pytest.mark.slow
def test_derivatives_are_finite_for_equal_widths():
    def of_widths(a, b, angle):
        normal, rough = lobe_of_matrix(lobe_matrix(NORMALS[1], roughness_matrix(a, b, angle)))
        return jnp.sum(normal) + jnp.sum(rough) + jnp.sum(tangent(rough)) + squared_widths(rough)[0]

    slopes = jax.grad(of_widths, (0, 1, 2))(0.3, 0.3, 0.2)
    assert np.all(np.isfinite(slopes))


def test_the_derivative_of_the_normal_is_right():
    matrix = np.asarray(lobe_matrix(NORMALS[1], roughness_matrix(0.5, 0.2, 0.3)))
    change = np.array([[0.1, 0.3, -0.2], [0.3, 0.2, 0.5], [-0.2, 0.5, 0.4]])
    _, found = jax.jvp(lobe_normal, (matrix,), (change,))
    step = 1e-6
    above, below = (lobe_normal(matrix + sign * step * change) for sign in (1, -1))
    # The difference has an error of the order of step² and of rounding by step.
    assert np.allclose(found, (above - below) / (2 * step), atol=1e-8)
