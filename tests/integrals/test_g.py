"""G: every leg is exact, from d, ν → 0 to opaque layers; and the misprint in its definition."""

import functools
import itertools

import jax
import mpmath as mp
import numpy as np
import pytest

from integrals import G
from tests.batches import batched
from tests.integrals.differences import difference
from tests.integrals.problems import distance, exact_g

# The relative error that the closed form states. Its sums of exponential integrals do not cancel.
RELATIVE = 16 * np.finfo(float).eps
# Error of a finite difference relative to G/d and G/ν: roundings over the step, and the stencil.
DIFFERENCES = 1e-9
LEGS = ("closed_form", "quadrature", "monte_carlo")
WIDTH = {"closed_form": 256, "quadrature": 256, "monte_carlo": 32}


def points() -> np.ndarray:
    """Return d and ν, shape (2, n), over all magnitudes: thin and thick, normal and grazing."""
    rng = np.random.default_rng(0)
    wide = 10 ** rng.uniform([-12, -12], [2.8, 0], (400, 2))
    tiny = 10 ** rng.uniform([-290, -290], [0, 0], (100, 2))
    ordinary = rng.uniform([0, 0], [2, 1], (300, 2))
    # The closed form uses different formulas on the two sides of d + d/ν = 1.
    cos_v = rng.uniform(0.01, 1, 100)
    seam = np.stack([cos_v / (1 + cos_v) * (1 + 1e-12 * rng.normal(size=100)), cos_v], 1)
    return np.concatenate([wide, tiny, ordinary, seam]).T


@functools.cache
def exact():
    return [exact_g(*point) for point in points().T]


@functools.cache
def evaluator(leg):
    return batched(G.legs[leg], WIDTH[leg])


@functools.cache
def gradient(leg, mode=jax.grad):
    return batched(mode(lambda d, nu: G.legs[leg](d, nu).value, (0, 1)), WIDTH[leg])


@pytest.mark.parametrize("leg", ["closed_form", "quadrature"])
def test_each_leg_is_within_its_stated_error(leg):
    value, error = evaluator(leg)(*points())
    assert np.all(distance(value, exact()) <= error)


def test_closed_form_has_full_relative_precision():
    value, _ = evaluator("closed_form")(*points())
    assert np.all(distance(value, exact()) <= RELATIVE * np.array(exact()).astype(float))


def test_stated_error_of_the_quadrature_is_small():
    _, error = evaluator("quadrature")(*points())
    assert np.all(error < 1e-11)


def test_stated_error_holds_for_a_coarse_quadrature():
    for step in (1 / 2, 1 / 3, 1 / 4):
        value, error = jax.jit(jax.vmap(functools.partial(G.quadrature, step=step)))(*points())
        miss = distance(value, exact())
        assert miss.max() > 1e-7
        assert np.all(miss <= error)


@pytest.mark.parametrize("sequence", ["random", "sobol"])
def test_monte_carlo_is_within_five_standard_errors(sequence):
    """Only where d and ν are so large that enough samples fall within them. The seed is fixed."""
    rng = np.random.default_rng(2)
    sample = rng.uniform([0.01, 0.02], [2, 1], (24, 2)).T
    value, error = jax.jit(jax.vmap(functools.partial(G.monte_carlo, sequence=sequence)))(*sample)
    assert np.all(distance(value, [exact_g(*point) for point in sample.T]) <= 5 * error)


@pytest.mark.parametrize("leg", LEGS)
def test_limits(leg):
    empty, grazing = [(0, 1e-300), (0, 1e-9), (0, 1)], [(1e-300, 0), (1, 0), (1e9, 0)]
    value, _ = evaluator(leg)(*np.array(empty + grazing).T)
    np.testing.assert_array_equal(value, [0, 0, 0, 1, 1, 1])


@pytest.mark.parametrize("leg", LEGS)
def test_corner_without_a_limit_is_nan(leg):
    """With d = xν, G → 1 − e^(−x) as ν → 0, which may be any number in [0, 1)."""
    value, error = evaluator(leg)(*np.zeros((2, 1)))
    assert np.isnan(value).all()
    assert np.isnan(error).all()


def test_limit_at_the_corner_depends_on_the_direction():
    ways = np.array([1e-3, 0.1, 1.0, 10.0])
    value, _ = evaluator("closed_form")(1e-12 * ways, np.full(4, 1e-12))
    np.testing.assert_allclose(value, -np.expm1(-ways), atol=1e-10)


@pytest.mark.parametrize("leg", LEGS)
def test_slope_at_grazing_views_is_minus_infinity(leg):
    """G = 1 + ν ln ν + O(ν), so the derivative in ν is −∞ for every leg."""
    by_density, by_cosine = gradient(leg)(np.array([1e-6, 0.5, 20.0]), np.zeros(3))
    np.testing.assert_array_equal(by_cosine, -np.inf)
    np.testing.assert_array_equal(by_density, 0)

    def value(d, nu):
        return G.legs[leg](d, nu).value

    forward = jax.jit(lambda d, nu: (jax.jacfwd(value, 0)(d, nu), jax.jacfwd(value, 1)(d, nu)))
    assert forward(0.5, 0.0) == (0, -np.inf)


def test_slope_near_grazing_views_is_logarithmic():
    nu = np.array([1e-6, 1e-9, 1e-12])
    slope = gradient("closed_form")(np.full(3, 0.5), nu)[1]
    np.testing.assert_allclose(np.diff(slope) / np.diff(np.log(nu)), 1, rtol=1e-4)


@pytest.mark.parametrize("leg", LEGS)
@pytest.mark.parametrize("mode", [jax.grad, jax.jacfwd])
def test_derivatives_are_finite_on_the_closed_domain(leg, mode):
    ends = [0.0, 1e-300, 1e-12, 1e-3, 0.5, 1.0, 30.0, 1e9, 1e300]
    d, nu = np.array([(d, nu) for d in ends for nu in ends if 0 < nu <= 1]).T
    # ν = 1e-300 with d/ν ~ 1 is left out by `ends`: G changes by one over a distance of 1e-300.
    for derivative in gradient(leg, mode)(d, nu):
        assert np.isfinite(derivative).all()


@pytest.mark.parametrize("leg", LEGS)
def test_derivatives_equal_finite_differences(leg):
    rng = np.random.default_rng(1)
    d, nu = 10 ** rng.uniform([-6, -6], [1, 0], (50 if leg == "monte_carlo" else 200, 2)).T
    sample = np.stack([np.append(d, [0.0, 0.0, 0.3]), np.append(nu, [0.2, 1.0, 1.0])])

    def value(x):
        return evaluator(leg)(*x).value

    derivatives = gradient(leg)(*sample)
    # G changes over distances of d and of ν. At d = 0 its second derivative is logarithmic.
    steps = 1e-3 * np.stack([np.where(sample[0] > 0, sample[0], 1e-9), sample[1]])
    for axis, upper in ((0, np.inf), (1, 1.0)):
        expected = difference(value, sample, axis, steps[axis], 0.0, upper)
        scale = np.maximum(abs(expected), np.asarray(value(sample)) / sample[axis].clip(1e-9))
        at_zero = sample[0] == 0
        allowed = np.where(at_zero, 1e-6, DIFFERENCES) * np.maximum(scale, 1e-6)
        assert np.all(abs(derivatives[axis] - expected) <= allowed)


def test_gradients_equal_exact_derivatives():
    """Compared with differences of the 50-digit value, because those of float64 lose digits."""
    sample = np.array([[1e-9, 0.3], [1e-6, 1e-9], [0.4, 0.7], [30.0, 1e-4], [1e-3, 1.0]]).T
    by_density, by_cosine = gradient("closed_form")(*sample)
    for i, (d, nu) in enumerate(sample.T):
        with mp.workdps(60):
            expected = [
                float((exact_g_at(d + e * h, nu) - exact_g_at(d - e * h, nu)) / (2 * h * e))
                if axis == 0
                else float((exact_g_at(d, nu + e * h) - exact_g_at(d, nu - e * h)) / (2 * h * e))
                for axis, h, e in (
                    (0, mp.mpf(d), mp.mpf(10) ** -15),
                    (1, mp.mpf(nu), mp.mpf(10) ** -15),
                )
            ]
        np.testing.assert_allclose([by_density[i], by_cosine[i]], expected, rtol=1e-13)


def exact_g_at(d, nu):
    e1 = mp.e1(d)
    escaped = mp.exp(-d / nu) * (mp.exp(-d) - d * e1 - nu * e1)
    return 1 - nu * mp.log(1 + 1 / nu) - escaped - nu * mp.e1(d + d / nu)


def test_second_derivatives_are_finite_where_smooth():
    d, nu = np.array([(d, nu) for d in (1e-6, 0.1, 3.0) for nu in (1e-3, 0.3, 1.0)]).T
    hessian = jax.vmap(jax.hessian(lambda d, nu: G.closed_form(d, nu).value, (0, 1)))
    by = jax.jit(hessian)(d, nu)
    assert np.isfinite(by).all()
    np.testing.assert_allclose(by[0][1], by[1][0], rtol=1e-10, atol=1e-30)
    # G = 1 − e^(−d/ν) E₂(d) − ν K gives ∂G/∂d = e^(−d/ν) E₂(d)/ν, and this gives ∂²G/∂d².
    e2 = np.array([float(mp.expint(2, x)) for x in d])
    e1 = np.array([float(mp.e1(x)) for x in d])
    np.testing.assert_allclose(by[0][0], -np.exp(-d / nu) * (e2 / nu + e1) / nu, rtol=1e-12)


def truncated_average(exponent_cosine, cutoff: float) -> float:
    """Average g over the lights with |u·v| > `cutoff`, at d = 1 and v·n = 0.6.

    `exponent_cosine` maps u·n and u·v to the factor that multiplies v·n in the exponent.
    """
    cos_v, nodes = 0.6, 300
    sin_v = np.sqrt(1 - cos_v**2)
    x, weights = np.polynomial.legendre.leggauss(nodes)
    cos_u = (x[:, None] + 1) / 2
    phi = np.pi * (np.arange(nodes) + 0.5) / nodes
    cos_uv = cos_u * cos_v + np.sqrt(1 - cos_u**2) * sin_v * np.cos(phi)
    with np.errstate(over="ignore"):
        exponent = (cos_u + cos_v) / (exponent_cosine(cos_u, cos_uv) * cos_v)
        kernel = cos_u * -np.expm1(-exponent) / (cos_u + cos_v)
    kernel = np.where(abs(cos_uv) > cutoff, kernel, 0)
    return float(np.sum(weights[:, None] / 2 * kernel) / nodes)


def test_printed_exponent_diverges_and_corrected_one_converges():
    """(u·v)(v·n) is negative for u·v < 0, and then the integral of e^(1/|u·v|) diverges."""
    cutoffs = (0.2, 0.1, 0.05, 0.025)
    printed = [truncated_average(lambda cos_u, cos_uv: cos_uv, cutoff) for cutoff in cutoffs]
    assert all(value < 0 for value in printed)
    for before, after in itertools.pairwise(printed):
        assert after < 10 * before
    corrected = [truncated_average(lambda cos_u, cos_uv: cos_u, cutoff) for cutoff in cutoffs]
    whole = truncated_average(lambda cos_u, cos_uv: cos_u, 0.0)
    np.testing.assert_allclose(whole, float(exact_g(1.0, 0.6)), atol=1e-6)
    misses = [abs(value - whole) for value in corrected]
    for before, after in itertools.pairwise(misses):
        assert after < 0.6 * before
