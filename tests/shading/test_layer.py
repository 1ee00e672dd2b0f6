"""The scattering kernel and the penetration have full precision, also at grazing directions."""

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest

from shading import optical_path, penetration, scattering_kernel

# A few correctly rounded operations and one exponential.
ROUNDING = 2e-15


def exact_kernel(cos_u, cos_v, density):
    with mp.workdps(40):
        cos_u, cos_v, density = map(mp.mpf, (cos_u, cos_v, density))
        path = density * (cos_u + cos_v) / (cos_u * cos_v)
        return cos_u * -mp.expm1(-path) / (cos_u + cos_v)


def test_kernel_is_exact_for_all_magnitudes():
    rng = np.random.default_rng(0)
    for cos_u, cos_v, density in 10 ** rng.uniform([-12, -12, -12], [0, 0, 2], (300, 3)):
        kernel = float(scattering_kernel(cos_u, cos_v, density))
        assert abs(kernel / exact_kernel(cos_u, cos_v, density) - 1) < ROUNDING


def test_kernel_divided_by_the_cosine_of_the_light_is_reciprocal():
    for cos_u, cos_v, density in ((0.3, 0.9, 0.4), (1e-9, 0.5, 1e-9), (1.0, 1e-3, 7.0)):
        there = scattering_kernel(cos_u, cos_v, density) / cos_u
        back = scattering_kernel(cos_v, cos_u, density) / cos_v
        np.testing.assert_allclose(there, back, rtol=ROUNDING)


def test_kernel_of_a_thin_layer_is_its_optical_path():
    np.testing.assert_allclose(scattering_kernel(0.3, 0.7, 1e-20), 1e-20 / 0.7, rtol=ROUNDING)


def test_kernel_of_an_opaque_layer_is_a_ratio_of_cosines():
    np.testing.assert_allclose(scattering_kernel(0.3, 0.7, 1e300), 0.3, rtol=ROUNDING)


@pytest.mark.parametrize(
    ("cosine", "density", "value"),
    [(1.0, 0.0, 1.0), (0.5, 1.0, np.exp(-2)), (1e-200, 1.0, 0.0), (1e-9, 1e-9, np.exp(-1))],
)
def test_penetration_is_exp_of_minus_the_optical_path(cosine, density, value):
    np.testing.assert_allclose(penetration(cosine, density), value, rtol=ROUNDING)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_the_longest_optical_path_lets_no_light_through(dtype):
    """exp(−800) is zero in float32 and float64."""
    longest = optical_path(dtype(1), dtype(1e-30))
    assert longest.dtype == dtype
    assert jnp.exp(-longest) == 0
    assert optical_path(1.0, 0.002) == 500


def test_kernel_derivatives_are_finite_and_exact():
    gradient = jax.jit(jax.grad(scattering_kernel, (0, 1, 2)))
    # For cosines of 1e-155 and less, the derivative of their quotient overflows.
    for cos_u in (1e-150, 1e-9, 0.4, 1.0):
        for cos_v in (1e-150, 1e-9, 0.4, 1.0):
            for density in (0.0, 1e-300, 1e-9, 0.3, 1e9):
                assert np.isfinite(gradient(cos_u, cos_v, density)).all(), (cos_u, cos_v, density)
    with mp.workdps(40):
        for point in ((0.4, 0.7, 0.3), (1e-9, 0.4, 1e-9), (1e-3, 1e-9, 1e-10)):
            exact = [
                mp.diff(
                    exact_kernel, point, tuple(int(i == j) for j in range(3)), h=point[i] * 1e-15
                )
                for i in range(3)
            ]
            # Allow for the rounding of g: a cosine may change g by less than that.
            scale = float(exact_kernel(*point)) / np.array(point)
            miss = np.abs(np.array(gradient(*point)) - [float(e) for e in exact])
            assert np.all(miss < 10 * ROUNDING * np.maximum(scale, np.abs(exact).astype(float)))
