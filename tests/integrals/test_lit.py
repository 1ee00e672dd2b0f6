"""E_lit: the integral over one variable, the hemisphere rule, Monte Carlo, limits, derivatives."""

import functools

import jax
import numpy as np
import pytest
from scipy.integrate import quad

from integrals import PS
from integrals.fuzz.lit import E_LIT, hemisphere
from tests.batches import batched
from tests.integrals.differences import difference
from tests.integrals.problems import RIGHT, awkward_points

EPS = np.finfo(float).eps

# (α, θf, θv, φ) and E_lit, from an independent hemisphere rule whose steps 1/16 and 1/20 agree.
TABLE = np.array(
    [
        (0.5, np.pi / 4, np.pi / 3, np.pi / 3, 0.304730607),
        (np.sqrt(0.05), np.pi / 4, np.arccos(0.35), np.pi / 4, 0.118144670),
        (np.sqrt(0.05), RIGHT, np.arccos(0.1), np.pi, 0.327022796),
        (np.sqrt(0.5), np.radians(23), np.arccos(0.7), np.radians(135), 0.433907279),
        (1.0, 0.0, np.pi / 3, 0.0, 0.5),
    ]
).T


@functools.cache
def quadrature(nodes=256):
    return batched(functools.partial(E_LIT.quadrature, nodes=nodes), 64)


@functools.cache
def by_hemisphere(nodes=256):
    return batched(functools.partial(hemisphere, nodes=nodes), 4)


def test_table():
    value, error = quadrature()(*TABLE[:4])
    np.testing.assert_allclose(value, TABLE[4], rtol=0, atol=5.1e-10)
    assert error.max() < 1e-11


def test_both_rules_agree_within_their_stated_errors():
    """They share the density only. The hemisphere rule needs an α that it resolves."""
    points = awkward_points(1, 40, 0.15)
    value, error = quadrature()(*points)
    other, other_error = by_hemisphere()(*points)
    gap = abs(value - other)
    assert np.all(gap <= error + other_error)
    assert gap.max() < 1e-10
    assert error.max() < 1e-8
    assert np.median(error) < 1e-13


@pytest.mark.slow
def test_both_rules_agree_at_many_points():
    points = awkward_points(2, 400, 0.02)
    value, error = quadrature()(*points)
    other, other_error = by_hemisphere()(*points)
    assert np.all(abs(value - other) <= error + other_error)


@functools.cache
def gradients():
    return batched(jax.grad(lambda point: E_LIT.quadrature(*point).value), 24)


@pytest.mark.parametrize(("least_alpha", "median"), [(0.02, 1e-12), (1e-3, 1e-7), (1e-9, 1e-5)])
def test_stated_error_holds_for_a_coarse_rule(least_alpha, median):
    """Nothing but the rule itself, with four times the nodes, is exact enough for such α."""
    points = awkward_points(3, 256, least_alpha)
    exact = quadrature(1024)(*points)
    for nodes in (64, 256):
        value, error = quadrature(nodes)(*points)
        assert np.all(abs(value - exact.value) <= error)
    assert np.median(error) < median


def test_stated_error_of_a_coarse_hemisphere_rule():
    points = awkward_points(4, 100, 0.02)
    value, error = by_hemisphere(32)(*points)
    miss = abs(value - quadrature()(*points).value)
    assert miss.max() > 1e-2
    assert np.all(miss <= error + quadrature()(*points).error)


def test_monte_carlo():
    points = awkward_points(5, 8, 0.1)
    value, error = batched(E_LIT.monte_carlo, 2)(*points)
    assert np.all(abs(value - quadrature()(*points).value) < 5 * np.maximum(error, EPS))
    assert error.max() < 0.01


def test_isotropic_fibres():
    points = awkward_points(6, 100, 0.15)
    points[0] = 1.0
    np.testing.assert_allclose(quadrature()(*points).value, 0.5, rtol=0, atol=1e-14)


def test_thin_fibres_scatter_as_much_either_way():
    """As α → 0, u·t → −v·t, so σ_F(u) → σ_F(v): the limit is 1 − P_s(v)."""
    rng = np.random.default_rng(7)
    angles = [rng.uniform(0.2, 1.3, 64), rng.uniform(0, 1.4, 64), rng.uniform(0.3, 2.8, 64)]
    gaps = []
    for alpha in (1e-2, 1e-3, 1e-4):
        points = np.stack([np.full(64, alpha), *angles])
        gaps.append(abs(quadrature()(*points).value - 1 + batched(PS.value, 64)(*points)).max())
    assert gaps[2] < 1e-3
    assert gaps[2] < gaps[1] / 5 < gaps[0] / 25


@pytest.mark.parametrize("alpha", [0.05, 0.3, 0.8])
def test_view_and_fibre_upright(alpha):
    """At v = t = n the azimuth drops out: 2α³ ∫₀¹ ds / (√(1 − κs²) (1 + α² + κs)²)."""
    kappa = 1 - alpha**2

    def integrand(s):
        return 2 * alpha**3 / (np.sqrt(1 - kappa * s * s) * (1 + alpha**2 + kappa * s) ** 2)

    exact, _ = quad(integrand, 0, 1, epsabs=1e-14, epsrel=1e-13)
    value = quadrature()([alpha], [0.0], [0.0], [0.0]).value[0]
    assert abs(value - exact) < 1e-13


def test_symmetries():
    alpha, theta_f, theta_v, phi = points = awkward_points(8, 100, 0.15)
    value, error = quadrature()(*points)
    mirrored = quadrature()(alpha, theta_f, theta_v, -phi)
    assert np.all(abs(mirrored.value - value) <= error + mirrored.error)
    # t → −t. A fibre along the surface is the only one whose opposite is in the domain.
    lying = np.full_like(theta_f, RIGHT)
    one, other = (quadrature()(alpha, lying, theta_v, azimuth) for azimuth in (phi, np.pi - phi))
    assert np.all(abs(one.value - other.value) <= one.error + other.error)


def test_both_hemispheres_make_the_whole_sphere():
    """For v and t along the surface, E_lit is half of the integral over the sphere.

    The upper and the lower hemisphere are mirror images there. The integral over the sphere depends
    on v·t only. For α² = 0.05 an independent rule gives 1.052, .978 and .512.
    """
    alpha = np.full(3, np.sqrt(0.05))
    between = np.arccos([0.0, 0.8, 1.0])
    value = quadrature()(alpha, np.full(3, RIGHT), np.full(3, RIGHT), between).value
    np.testing.assert_allclose(2 * value, [1.052, 0.978, 0.512], rtol=0, atol=5.1e-4)


@pytest.mark.slow
def test_derivatives():
    points = awkward_points(9, 24, 0.3)
    points[1:] = np.clip(points[1:], 0.05, 1.5)
    gradient = gradients()(points.T).T
    for axis in range(4):
        slope = difference(lambda p: quadrature()(*p).value, points, axis, 1e-3, -9.0, 9.0)
        np.testing.assert_allclose(gradient[axis], slope, rtol=0, atol=3e-6)


@pytest.mark.slow
def test_derivatives_are_finite_on_the_whole_domain():
    points = awkward_points(10, 96, 1e-3)
    ends = np.stack(
        np.meshgrid([0.15, 1.0], [0.0, 0.7, RIGHT], [0.0, 0.7, RIGHT], [0.0, np.pi])
    ).reshape(4, -1)
    assert np.all(np.isfinite(gradients()(np.concatenate([points, ends], axis=1).T)))
    with pytest.raises(TypeError, match="no derivative"):
        jax.grad(lambda x: E_LIT.monte_carlo(x, 0.3, 0.4, 0.5, samples=64).value)(0.5)


def test_outside_the_domain():
    outside = np.array([(0.0, 1, 1, 1), (1.1, 1, 1, 1), (0.5, 1.6, 1, 1), (0.5, 1, -0.1, 1)]).T
    assert np.all(np.isnan(quadrature()(*outside).value))
