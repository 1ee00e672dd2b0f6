"""The piecewise-linear NDF: values, mass, moments and the blend, against quadrature."""

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest

from shading.piecewise import slopes
from shading.piecewise.blend import Blend, azimuth_cdf, blend_density, weights
from shading.piecewise.defects import chord_defect, sine_defect, tangent_defect
from shading.piecewise.moments import mass, mass_below, moment, normalised
from shading.piecewise.ndf import VARIABLES, Profile, density, profile, uniform_knots
from tests.integrals.piecewise_examples import (
    blend_values,
    gauss,
    random_blend,
    random_profile,
    values_of,
)

# Sums of about a hundred numbers of the order of one.
ROUNDING = 1e-14


@pytest.mark.parametrize("variable", VARIABLES)
def test_values_mass_and_moment_are_those_of_quadrature(variable):
    ndf = random_profile(3, 9, variable)
    theta, w = gauss(np.asarray(ndf.knots))
    d = values_of(ndf, theta)
    np.testing.assert_allclose(jax.vmap(lambda t: density(ndf, t))(theta), d, rtol=ROUNDING)
    # Eq. 5
    assert abs(2 * np.pi * np.sum(w * d * np.cos(theta) * np.sin(theta)) - 1) < ROUNDING
    assert abs(float(mass(ndf)) - 1) < ROUNDING
    # Eq. 15
    np.testing.assert_allclose(moment(ndf), np.sum(w * d * np.sin(theta) ** 2), rtol=ROUNDING)
    for upper in (0.0, 0.03, 0.7, 1.3, np.pi / 2):
        knots = np.asarray(ndf.knots)
        theta, w = gauss([0.0, *knots[(knots > 0) & (knots < upper)], upper])
        part = 2 * np.pi * np.sum(w * values_of(ndf, theta) * np.cos(theta) * np.sin(theta))
        assert abs(float(mass_below(ndf, upper)) - part) < ROUNDING


@pytest.mark.slow
@pytest.mark.parametrize("variable", VARIABLES)
def test_narrow_segments_lose_no_digits(variable):
    knots = np.concatenate([np.geomspace(1e-5, np.pi / 2, 40)])
    ndf = profile([0, *knots], slopes.student_t(np.array([0, *knots]), 1e-3, 2.0), variable)
    theta, w = gauss(np.asarray(ndf.knots))
    d = values_of(ndf, theta)
    np.testing.assert_allclose(
        mass(ndf), 2 * np.pi * np.sum(w * d * np.cos(theta) * np.sin(theta)), rtol=1e-13
    )
    np.testing.assert_allclose(moment(ndf), np.sum(w * d * np.sin(theta) ** 2), rtol=1e-13)


def test_the_blend_is_equation_1_and_normalised():
    ndf = random_blend(5)
    theta, w = gauss(np.asarray(ndf.x.knots))
    phi = np.arange(64) * 2 * np.pi / 64
    at, turn = np.meshgrid(theta, phi, indexing="ij")
    values = jax.vmap(lambda t, p: blend_density(ndf, t, p))(at.ravel(), turn.ravel())
    np.testing.assert_allclose(values, blend_values(ndf, at, turn).ravel(), rtol=ROUNDING)
    # Eq. 2 and 3: c of Eq. 1 is the mass of what is not yet divided by c.
    over = np.reshape(values, at.shape).mean(axis=1) * 2 * np.pi
    assert abs(np.sum(w * over * np.cos(theta) * np.sin(theta)) - 1) < ROUNDING
    # Eq. 7
    for upper in (0.4, 2.0, 5.0):
        turn, w_phi = gauss([0, upper])
        d = blend_values(ndf, theta[:, None], turn)
        part = np.sum((w * np.cos(theta) * np.sin(theta)) @ d * w_phi)
        assert abs(float(azimuth_cdf(ndf, upper)) - part) < ROUNDING


def test_a_profile_that_is_zero_at_the_normal_takes_all_the_weight():
    x, y = (random_profile(seed) for seed in (1, 2))
    zero = normalised(Profile(x.knots, x.values.at[0].set(0.0)))
    assert [float(each) for each in weights(Blend(zero, y))] == [1, 0]
    assert [float(each) for each in weights(Blend(x, zero))] == [0, 1]
    # The limit of Eq. 1 as D_x(0) → 0 is 2cos²φ D_x.
    near = Profile(zero.knots, zero.values.at[0].set(1e-9))
    at = (0.6, 0.3)
    np.testing.assert_allclose(
        blend_density(Blend(near, y), *at), blend_density(Blend(zero, y), *at), rtol=1e-7
    )
    # Both zero: cos²φ D_x + sin²φ D_y, which is another function than either limit.
    other = normalised(Profile(y.knots, y.values.at[0].set(0.0)))
    both = Blend(zero, other)
    expected = np.cos(0.3) ** 2 * density(zero, 0.6) + np.sin(0.3) ** 2 * density(other, 0.6)
    np.testing.assert_allclose(blend_density(both, *at), expected, rtol=ROUNDING)


def test_the_blend_of_ggx_is_not_anisotropic_ggx():
    """The total variation between both is .54 for widths .1 and .8: not "slightly different"."""
    ax, ay = 0.1, 0.8
    theta, w = gauss(np.concatenate([[0], np.geomspace(0.01, np.pi / 2, 24)]), 24)
    phi = (np.arange(256) + 0.5) * 2 * np.pi / 256
    at, turn = theta[:, None], phi[None]
    x, y = (np.asarray(slopes.student_t(at, each, 2.0)) for each in (ax, ay))
    x0, y0 = 1 / (np.pi * ax**2), 1 / (np.pi * ay**2)
    blended = (np.cos(turn) ** 2 * x * y0 + np.sin(turn) ** 2 * y * x0) / ((x0 + y0) / 2)
    form = (np.cos(turn) / ax) ** 2 + (np.sin(turn) / ay) ** 2
    known = 1 / (np.pi * ax * ay * (np.cos(at) ** 2 + np.sin(at) ** 2 * form) ** 2)
    gap = np.abs(blended - known).mean(axis=1) * 2 * np.pi
    assert abs(np.sum(w * gap * np.cos(theta) * np.sin(theta)) / 2 - 0.54) < 5e-3
    ratio = (1 / (np.pi * (ax**2 + ay**2) / 2)) / (1 / (np.pi * ax * ay))
    assert abs(blended[0, 0] / known[0, 0] - ratio) < 1e-3


@pytest.mark.slow
def test_analytic_ndfs_are_normalised_and_agree_in_their_limits():
    theta, w = gauss(np.concatenate([[0], np.geomspace(0.003, np.pi / 2, 40)]), 30)
    for values in (
        slopes.student_t(theta, 0.2, 2.0),
        slopes.student_t(theta, 0.2, 4.5),
        slopes.beckmann(theta, 0.2),
    ):
        assert abs(2 * np.pi * np.sum(w * values * np.cos(theta) * np.sin(theta)) - 1) < 1e-12
    ggx = 0.2**2 / (np.pi * (0.2**2 * np.cos(theta) ** 2 + np.sin(theta) ** 2) ** 2)
    np.testing.assert_allclose(slopes.student_t(theta, 0.2, 2.0), ggx, rtol=1e-13)
    np.testing.assert_allclose(
        slopes.student_t(theta[:400], 0.2, 1e7), slopes.beckmann(theta[:400], 0.2), rtol=1e-4
    )
    assert slopes.beckmann(np.pi / 2, 0.2) == 0


def test_defects_keep_their_digits():
    for x in (1e-9, 1e-3, 0.3, 0.44, 0.46, 0.99, 1.01, 3.0):
        with mp.workdps(40):
            z = mp.mpf(x)
            exact = (z - mp.sin(z), mp.sin(z) - z * mp.cos(z), z - mp.atan(z))
            found = (sine_defect(x), chord_defect(x), tangent_defect(x))
            for one, other in zip(found, exact, strict=True):
                assert abs(float(mp.mpf(float(one)) / other - 1)) < 4e-15


@pytest.mark.slow
def test_the_mass_is_linear_in_the_values_and_differentiable():
    ndf = random_profile(8)
    slopes_of = jax.grad(lambda values: mass(Profile(ndf.knots, values)))(ndf.values)
    np.testing.assert_allclose(slopes_of @ ndf.values, 1, rtol=ROUNDING)
    moved = jax.grad(lambda t: density(ndf, t))(jnp.array(0.4))
    ahead, behind = density(ndf, 0.4 + 1e-6), density(ndf, 0.4 - 1e-6)
    np.testing.assert_allclose(moved, (ahead - behind) / 2e-6, rtol=1e-7)


@pytest.mark.parametrize(
    ("knots", "values", "variable", "said"),
    [
        ([0, 1, np.pi / 2], [1, 1, 0], "angel", "allowed are angle, cos2"),
        ([0, 1.6], [1, 1], "angle", "allowed are those from 0 to π/2"),
        ([0, 1, 1, np.pi / 2], [1, 1, 1, 1], "angle", "increase"),
        ([0, np.pi / 2], [1, 1, 1], "angle", "two arrays"),
        ([0, np.pi / 2], [0, 0], "angle", "not all zero"),
        ([0, np.pi / 2], [1, -1], "angle", "finite numbers ≥ 0"),
        ([0, np.pi / 2], [1, np.nan], "angle", "finite numbers ≥ 0"),
    ],
)
def test_bad_profiles_are_refused(knots, values, variable, said):
    with pytest.raises(ValueError, match=said):
        profile(knots, values, variable)


def test_uniform_knots_need_a_segment():
    assert len(uniform_knots(3)) == 4
    with pytest.raises(ValueError, match="allowed are 1 and more"):
        uniform_knots(0)
