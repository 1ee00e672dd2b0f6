"""P_s of fibres: the closed form, compared with 50 digits and with quadratures."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import cubature

from integrals import PS
from integrals.fuzz.ps import quick_fraction_at
from shading.fuzz.lit_cone import FLOAT32_STEPS, FLOAT64_STEPS, scattered_fraction
from tests.batches import batched
from tests.integrals.problems import RIGHT, awkward_points, distance, exact_ps

EPS, FLOAT32_EPS = np.finfo(float).eps, np.finfo(np.float32).eps
# The largest difference of closed form and quadrature for α ≥ 0.15: for u·n ≥ 0.05, and for all.
AGREEMENT, AGREEMENT_AT_GRAZING = 1e-12, 1e-9
NOT_GRAZING = 0.05
# The largest error in float32 that is allowed, and that is reached (2.9e-7 over 2e6 points).
FLOAT32_ALLOWED, FLOAT32_ATTAINED = 3e-6, 5e-7
# The largest error of P_s from the start of the root alone. 0.0145 was measured, for any α.
START = 0.015


@functools.cache
def closed_form():
    return batched(PS.closed_form, 256)


@functools.cache
def quadrature(**options):
    return batched(functools.partial(PS.quadrature, **options), 8)


@functools.cache
def fraction(steps):
    return jax.jit(jax.vmap(functools.partial(scattered_fraction, steps=steps)))


@functools.cache
def exact(seed, count, least_alpha):
    return [exact_ps(*point) for point in awkward_points(seed, count, least_alpha).T]


@pytest.mark.parametrize("least_alpha", [0.15, 0.02, 1e-3, 1e-9])
def test_closed_form_is_within_its_stated_error(least_alpha):
    points = awkward_points(1, 300, least_alpha)
    value, error = closed_form()(*points)
    np.testing.assert_array_equal(error, 4 * EPS / points[0])
    assert np.all(distance(value, exact(1, 300, least_alpha)) <= error)


@pytest.mark.parametrize("least_alpha", [0.15, 0.02, 1e-3, 1e-9])
def test_the_quick_version_is_within_the_error_stated_for_the_closed_form(least_alpha):
    points = awkward_points(1, 300, least_alpha)
    value = batched(quick_fraction_at, 256)(*points)
    assert np.all(distance(value, exact(1, 300, least_alpha)) <= 4 * EPS / points[0])


def test_rounded_cosines_alone_are_not_precise_enough():
    """Near the fibre 1 − (u·t)² is all rounding error. This is why sines use half angles."""
    points = awkward_points(1, 300, 1e-9)
    rounded = functools.partial(scattered_fraction, least_alpha=1e-50)
    value = jax.jit(jax.vmap(rounded))(*cosines(points))
    assert np.any(distance(value, exact(1, 300, 1e-9)) > 1000 * EPS / points[0])


@pytest.mark.parametrize(("seed", "least_alpha"), [(2, 0.15), (3, 0.02), (4, 1e-3), (5, 1e-9)])
def test_quadrature_is_within_its_stated_error(seed, least_alpha):
    points = awkward_points(seed, 200, least_alpha)
    value, error = quadrature()(*points)
    assert np.all(distance(value, exact(seed, 200, least_alpha)) <= error)
    # The stated error is small where the rule resolves α.
    assert np.all(error[points[0] > 0.15] < AGREEMENT)


@pytest.mark.parametrize("nodes", [16, 97])
def test_stated_error_holds_for_a_coarse_quadrature(nodes):
    points = awkward_points(6, 1000, 0.01)
    value, error = quadrature(nodes=nodes)(*points)
    miss = abs(value - closed_form()(*points).value)
    assert miss.max() > 1e-2
    assert np.all(miss <= error + 4 * EPS / points[0])


def grazing_points() -> np.ndarray:
    cosines = np.concatenate([10.0 ** -np.arange(1, 13), [0.0, 0.05]])
    # Include θu = π/2 and the float64 number below it, and cosines down to 1e-12.
    theta_u = np.append(RIGHT - np.arcsin(cosines), [np.nextafter(RIGHT, 0), RIGHT])
    grid = np.meshgrid([0.15, 0.5], [0.0, 0.8, RIGHT], theta_u, [0.0, 0.7, np.pi])
    return np.stack([axis.ravel() for axis in grid])


def test_closed_form_and_quadrature_agree_down_to_grazing():
    points = np.concatenate([awkward_points(7, 150, 0.15), grazing_points()], axis=1)
    gap = abs(closed_form()(*points).value - quadrature()(*points).value)
    assert np.all(gap[np.cos(points[2]) >= NOT_GRAZING] <= AGREEMENT)
    assert np.all(gap <= AGREEMENT_AT_GRAZING)
    # In fact grazing light costs no precision.
    assert np.all(gap <= 1e-14)


def definition(alpha, theta_f, theta_u, phi):
    """Integrate p_F over the angles of v by SciPy. This shares no code with the legs."""
    t = np.array([np.sin(theta_f), 0, np.cos(theta_f)])
    u = np.array([np.sin(theta_u) * np.cos(phi), np.sin(theta_u) * np.sin(phi), np.cos(theta_u)])
    sigma = np.sqrt(1 - (u @ t) ** 2 * (1 - alpha**2))

    def integrand(angles):
        theta, azimuth = angles.T
        sine = np.sin(theta)
        v = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(theta)])
        h = u[:, None] + v
        cos_ht = (t @ h) / np.linalg.norm(h, axis=0)
        spread = np.pi * (cos_ht**2 * (1 - alpha**2) + alpha**2) ** 2
        return alpha**3 / spread / (4 * sigma) * sine

    result = cubature(integrand, [0, -np.pi], [RIGHT, np.pi], rtol=0, atol=1e-11)
    assert result.status == "converged"
    return 1 - result.estimate


@pytest.mark.parametrize(
    "point",
    [(0.3, 0.6, 0.4, 1.0), (0.15, 1.2, 1.1, 2.5), (0.7, RIGHT, 1.2, 0.3), (0.9, 0.1, 0.0, 0.0)],
)
def test_agrees_with_quadrature_in_the_angles_of_v(point):
    assert abs(definition(*point) - float(PS.closed_form(*point).value)) < 1e-10


def test_symmetries():
    alpha, theta_f, theta_u, phi = points = awkward_points(11, 300, 0.15)
    value = closed_form()(*points).value
    tolerance = {"atol": 4 * EPS / 0.15, "rtol": 0}
    for same in (-phi, phi - 2 * np.pi, 2 * np.pi - phi):
        moved = closed_form()(alpha, theta_f, theta_u, same).value
        np.testing.assert_allclose(moved, value, **tolerance)
    lying, upright = np.full_like(theta_f, RIGHT), np.zeros_like(theta_f)
    np.testing.assert_allclose(
        closed_form()(alpha, lying, theta_u, np.pi - phi).value,
        closed_form()(alpha, lying, theta_u, phi).value,
        **tolerance,
    )
    np.testing.assert_allclose(
        closed_form()(alpha, upright, theta_u, phi).value,
        closed_form()(alpha, upright, theta_u, upright).value,
        **tolerance,
    )
    # t and −t are the same fibre.
    c, a, b, _ = cosines(points)
    np.testing.assert_allclose(
        fraction(FLOAT64_STEPS)(c, -a, -b, alpha),
        fraction(FLOAT64_STEPS)(c, a, b, alpha),
        **tolerance,
    )


def cosines(points):
    """Return u·n, u·t, n·t and α of points (4, n)."""
    alpha, theta_f, theta_u, phi = points
    sines = np.sin(theta_u) * np.sin(theta_f)
    cos_ut = np.cos(theta_u) * np.cos(theta_f) + sines * np.cos(phi)
    return np.cos(theta_u), cos_ut, np.cos(theta_f), alpha


@pytest.mark.slow
def test_numbers_of_newton_steps_are_sufficient_and_necessary():
    def worst(steps, least_alpha):
        arguments = cosines(awkward_points(12, 50_000, least_alpha))
        converged = fraction(FLOAT64_STEPS + 4)(*arguments)
        return float(abs(fraction(steps)(*arguments) - converged).max())

    for least_alpha in (1e-9, 1e-3, 0.05):
        assert worst(FLOAT64_STEPS, least_alpha) < 4 * EPS
        assert worst(FLOAT64_STEPS - 1, least_alpha) > 40 * EPS
        # Less than the roundings of float32 add. One step fewer leaves thousands of roundings.
        assert worst(FLOAT32_STEPS, least_alpha) < 1.5 * FLOAT32_EPS
        assert worst(FLOAT32_STEPS - 1, least_alpha) > 1000 * FLOAT32_EPS
        assert worst(0, least_alpha) < START


def test_start_is_exact_for_isotropic_fibres_and_grazing_light():
    points = awkward_points(15, 10_000, 0.05)
    for axis, end in ((0, 1.0), (2, RIGHT)):
        there = points.copy()
        there[axis] = end
        c, a, b, alpha = cosines(there)
        c = np.zeros_like(c) if axis == 2 else c
        start, exact = (fraction(steps)(c, a, b, alpha) for steps in (0, FLOAT64_STEPS))
        assert np.all(abs(start - exact) <= 4 * EPS / alpha)


@functools.cache
def float32_points():
    """Return 200,000 difficult points with α ≥ 0.05, and all corners, as cosines in float32."""
    alphas, halves = [0.05, 0.15, 0.5, 1.0], [0, 1e-6, 1e-3, 0.7, RIGHT - 1e-3, RIGHT - 1e-6, RIGHT]
    grid = np.meshgrid(alphas, halves, halves, np.multiply(halves, 2))
    corners = np.stack([axis.ravel() for axis in grid])
    points = np.concatenate([awkward_points(13, 200_000, 0.05), corners], axis=1)
    return [np.clip(x, -1, 1).astype(np.float32) for x in cosines(points)]


def test_float32_is_precise_enough_for_a_shader():
    arguments = float32_points()
    value = fraction(FLOAT32_STEPS)(*arguments)
    assert value.dtype == jnp.float32
    assert jnp.isfinite(value).all()
    # The exact value is for the rounded cosines. Their own rounding is not counted.
    truth = fraction(FLOAT64_STEPS)(*(x.astype(float) for x in arguments))
    error = float(abs(value.astype(float) - truth).max())
    assert error <= FLOAT32_ATTAINED <= FLOAT32_ALLOWED


def test_float32_is_finite_for_cosines_of_no_unit_vectors():
    rng = np.random.default_rng(14)
    c, a, b = rng.uniform([0, -1, -1], [1, 1, 1], (200_000, 3)).T.astype(np.float32)
    alpha = (10 ** rng.uniform(-30, 0, 200_000)).astype(np.float32)
    assert jnp.isfinite(fraction(FLOAT32_STEPS)(c, a, b, alpha)).all()
    # Cosines that are clamped, or that rounding moved beyond 1.
    ends = [0.0, 0.6, 1.0, 1 + FLOAT32_EPS]
    both, alphas = [*ends, *np.negative(ends)], [1e-30, 1e-6, 1e-4, 1e-3, 0.05, 1.0]
    grid = np.meshgrid([0.0, -FLOAT32_EPS, 1e-6, 1.0], both, both, alphas)
    values = fraction(FLOAT32_STEPS)(*(axis.ravel().astype(np.float32) for axis in grid))
    assert jnp.isfinite(values).all()


def test_float32_is_finite_where_two_roots_are_zero():
    """S − T may be rounded to zero at u·n = 0 in the plane of n and t as α → 0."""
    theta_f, alpha = np.meshgrid(np.linspace(0, RIGHT, 2001), [1e-30, 1e-5, 1e-4, 1e-3, 0.05])
    axes = (np.zeros_like(alpha), np.sin(theta_f), np.cos(theta_f), alpha)
    values = fraction(FLOAT32_STEPS)(*(axis.ravel().astype(np.float32) for axis in axes))
    assert jnp.isfinite(values).all()
