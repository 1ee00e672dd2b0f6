"""Fresnel's reflectances, compared with complex arithmetic."""

import jax
import numpy as np
import pytest

from shading.microfacet import conductor, dielectric, schlick


def exact(cosine, index):
    """Return Fresnel's reflectance for a complex index, from amplitudes of both polarisations."""
    refracted = np.sqrt(np.asarray(index * index - (1 - cosine * cosine), complex))
    across = (cosine - refracted) / (cosine + refracted)
    along = (index * index * cosine - refracted) / (index * index * cosine + refracted)
    return (abs(across) ** 2 + abs(along) ** 2) / 2


COSINES = np.array([1e-6, 0.01, 0.2, 0.5, 0.77, 1.0])
DIELECTRIC = jax.jit(jax.vmap(dielectric, (0, None)))
DIELECTRIC_SLOPES = jax.jit(jax.vmap(jax.grad(dielectric, (0, 1)), (0, None)))
CONDUCTOR = jax.jit(jax.vmap(conductor, (0, None, None)))
CONDUCTOR_SLOPES = jax.jit(jax.vmap(jax.grad(conductor, (0, 1, 2)), (0, None, None)))


@pytest.mark.parametrize("index", [0.5, 0.9, 1.0, 1.33, 2.0])
def test_dielectric(index):
    values = DIELECTRIC(COSINES, index)
    # At index 1 and a cosine of 1e-6 the formula with sines cancels to 3e-11.
    np.testing.assert_allclose(values, exact(COSINES, index), rtol=0, atol=1e-10)
    np.testing.assert_allclose(values[1:], exact(COSINES, index)[1:], rtol=0, atol=1e-15)
    assert dielectric(0.0, index) == 1
    slopes = DIELECTRIC_SLOPES(COSINES, index)
    assert np.isfinite(slopes).all()


@pytest.mark.parametrize("index", [0.05 + 4j, 0.2 + 3j, 1.5 + 0j, 3.6 + 2.7j, 1.0 + 8j])
def test_conductor(index):
    values = CONDUCTOR(COSINES, index.real, index.imag)
    np.testing.assert_allclose(values, exact(COSINES, index), rtol=0, atol=1e-15)
    assert conductor(0.0, index.real, index.imag) == 1
    slopes = CONDUCTOR_SLOPES(COSINES, index.real, index.imag)
    assert np.isfinite(slopes).all()


def test_a_conductor_that_absorbs_nothing_is_a_dielectric():
    np.testing.assert_allclose(
        CONDUCTOR(COSINES, 1.5, 0.0), DIELECTRIC(COSINES, 1.5), rtol=0, atol=1e-15
    )


def test_schlick_has_both_ends():
    assert float(schlick(1.0, 0.04)) == pytest.approx(0.04, abs=1e-17)
    assert schlick(0.0, 0.04) == 1
