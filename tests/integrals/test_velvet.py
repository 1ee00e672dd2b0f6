"""r(k): its three legs, and the theorem that light across the fibre has the most energy."""

import functools

import jax
import mpmath as mp
import numpy as np
import pytest

from integrals import VELVET
from integrals.fuzz.velvet import scattered_energy, series_coefficients
from tests.batches import batched
from tests.integrals.differences import difference

EPS = np.finfo(float).eps
DOMAIN_END = 0.95

VALUE = jax.jit(jax.vmap(VELVET.value))
SLOPE = jax.jit(jax.vmap(jax.grad(VELVET.value)))


def exact_norm(k) -> mp.mpf:
    """Return 1/r with 30 digits, by quadrature of its one-dimensional integral."""
    with mp.workdps(30):
        x = -mp.mpf(float(k))
        ridge = mp.sqrt(1 - x) if x > 0.5 else mp.mpf(1) / 2

        def integrand(y):
            return (mp.cos(y) / (1 - x * mp.cos(y))) ** 2

        points = [0, ridge, min(6 * ridge, mp.mpf(1)), mp.pi / 2]
        return mp.pi / (4 * (1 - x * x) * mp.quad(integrand, sorted(set(points))))


def asymmetries(seed, count) -> np.ndarray:
    """Return k near both ends of (−1, 0] and near −0.25, where the series takes over."""
    rng = np.random.default_rng(seed)
    kinds = [-(10.0 ** rng.uniform(-12, 0, count)), -1 + 10 ** rng.uniform(-9, 0, count)]
    kinds += [-rng.uniform(0.24, 0.26, count), np.array([0.0, -0.25, -0.95])]
    return np.concatenate(kinds)


@functools.cache
def energies():
    return jax.jit(jax.vmap(jax.vmap(scattered_energy, (None, 0)), (0, None)))


def test_closed_form_is_exact():
    k = asymmetries(0, 12)
    value, error = batched(VELVET.closed_form, 8)(k)
    exact = np.array([float(exact_norm(each)) for each in k])
    assert np.all(abs(value - exact) <= error)
    assert np.all(error <= 64 * EPS * value)


def test_quadrature_is_within_its_stated_error():
    k = asymmetries(1, 40)
    value, error = batched(VELVET.quadrature, 8)(k)
    exact, rounding = batched(VELVET.closed_form, 8)(k)
    assert np.all(abs(value - exact) <= error + rounding)
    assert np.all(error[k >= -DOMAIN_END] < 1e-13)


@pytest.mark.parametrize("sequence", ["random", pytest.param("sobol", marks=pytest.mark.slow)])
def test_monte_carlo_is_within_five_standard_errors(sequence):
    k = np.array([0.0, -0.1, -0.6, -0.95])
    value, error = jax.jit(jax.vmap(functools.partial(VELVET.monte_carlo, sequence=sequence)))(k)
    exact = VALUE(k)
    assert np.all(abs(value - exact) <= 5 * error + 4 * EPS)
    assert np.all(error < 1e-2)


def test_known_values():
    """r = 1 for isotropic scattering, and r → s/4 as k → −1, where s = √(1 − k²)."""
    assert VALUE(np.array([0.0])) == 1
    for gap in (1e-8, 1e-12):
        s = np.sqrt(gap * (2 - gap))
        np.testing.assert_allclose(VALUE(np.array([gap - 1])), s / 4, rtol=16 * np.sqrt(gap))
    np.testing.assert_allclose(SLOPE(np.array([0.0])), 16 / (3 * np.pi), rtol=1e-14)
    assert np.isnan(VALUE(np.array([-1.0, 0.1, np.nan]))).all()


def test_no_light_direction_gains_energy():
    """The energy decreases from u·t = 0 to u·t = 1, as docs/brdf.md proves."""
    k = np.array([-1e-3, -0.1, -0.5, -0.8, -0.95, -0.99])
    cosines = np.concatenate([[0.0, 1e-9], np.linspace(1e-3, 1, 60)])
    kept = np.asarray(energies()(k, cosines) * VALUE(k)[:, None])
    np.testing.assert_allclose(kept[:, 0], 1, rtol=0, atol=1e-12)
    assert np.all(np.diff(kept, axis=1) <= 1e-13)
    assert np.all(kept <= 1 + 1e-12)


def test_most_energy_is_lost_along_the_fibre():
    """∫ p dω_v at u = t is 2 (1 − x²) (ln(1 − x) + 1/(1 − x) − 1)/x²."""
    x = np.array([1e-3, 0.1, 0.5, 0.8, 0.95, 0.99])
    exact = 2 * (1 - x * x) * (np.log1p(-x) + 1 / (1 - x) - 1) / x**2
    found = energies()(-x, np.linspace(1, 0, 62))[:, 0]
    np.testing.assert_allclose(found, exact, rtol=1e-9)
    assert 0.29 < found[4] * VALUE(-x)[4] < 0.3


def test_printed_sign_would_create_energy():
    """With p_Schlick(k, +sin) and k < 0, r fitted at u·t = 0 would create energy elsewhere."""

    def printed(asymmetry, upright):
        y, weights = np.polynomial.legendre.leggauss(200)
        eta, weights = (y + 1) * np.pi / 4, weights * np.pi / 4
        sine = np.sin(eta)
        lobe = (1 - asymmetry**2) / (4 * np.pi * (1 - asymmetry * sine) ** 2)
        mean = 2 * np.pi * np.cos(eta) if upright else 4 * sine
        return 4 * np.sum(weights * sine * lobe * mean)

    assert printed(-0.5, True) > 1.1 * printed(-0.5, False)
    # With the sign of k reversed, the printed formula is the right one.
    np.testing.assert_allclose(printed(0.5, False), 1 / VALUE(np.array([-0.5])), rtol=1e-12)
    assert printed(0.5, True) < printed(0.5, False)


@pytest.mark.slow
def test_derivatives_are_finite_and_equal_finite_differences():
    k = np.concatenate([asymmetries(2, 5), [-1 + 1e-15]])
    slopes = SLOPE(k)
    assert np.isfinite(slopes).all()
    inside = k[k > -0.9]
    expected = difference(lambda x: VALUE(x[0]), inside[None], 0, 1e-3, -1, 0.0)
    np.testing.assert_allclose(SLOPE(inside), expected, atol=1e-7)
    by_quadrature = batched(jax.grad(lambda k: VELVET.quadrature(k).value), 8)(inside)
    np.testing.assert_allclose(by_quadrature, SLOPE(inside), atol=1e-11)


def test_series_has_positive_coefficients_that_grow_slowly():
    """The proof that a fit creates no energy bounds the remainder of the series by this."""
    a = series_coefficients(200)
    n = np.arange(199)
    assert a[0] == 1
    assert np.all(a > 0)
    assert np.all(a[1:] / a[:-1] < (n + 2) / (n + 1))
