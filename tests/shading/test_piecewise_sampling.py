"""Samples of normals, visible normals and reflections follow their densities, by chi-square."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shading import direction
from shading.piecewise.blend import Blend, azimuth_cdf
from shading.piecewise.moments import mass_below, normalised
from shading.piecewise.ndf import Profile, profile
from shading.piecewise.normal_sampling import (
    normal_pdf,
    sample_azimuth,
    sample_normal,
    sample_polar_angle,
)
from shading.piecewise.roots import increasing_root
from shading.piecewise.visible_sampling import (
    reflection_pdf,
    sample_reflection,
    sample_visible_normal,
    visible_area,
    visible_pdf,
)
from tests.integrals.piecewise_examples import random_blend, random_profile
from tests.shading.test_sampling import REJECTION, p_value

POINTS = np.random.default_rng(7).random((20_000, 2))
# Not monotone: the values are random. The second profile of the blend has other values.
PROFILE, BLEND = random_profile(3, 6, "cos2"), random_blend(6, 5, "cos2")
OUTGOING = {name: direction(theta, 0.7) for name, theta in [("high", 0.4), ("grazing", 1.5)]}

_normal = jax.jit(jax.vmap(sample_normal, (None, 0)))
_visible = jax.jit(jax.vmap(sample_visible_normal, (None, None, 0)))
_reflection = jax.jit(jax.vmap(sample_reflection, (None, None, 0)))
_normal_pdf = jax.jit(jax.vmap(normal_pdf, (None, 0)))
_visible_pdf = jax.jit(jax.vmap(visible_pdf, (None, None, 0)))
_reflection_pdf = jax.jit(jax.vmap(reflection_pdf, (None, None, 0)))


def upper(pdf):
    """Return a density that is zero below the horizon, where D is not defined."""
    return lambda at: np.where(at[:, 2] > 0, pdf(np.where(at[:, 2:] > 0, at, [0.0, 0.0, 1.0])), 0)


@pytest.mark.parametrize(
    "ndf",
    [
        pytest.param(PROFILE, marks=pytest.mark.slow),
        BLEND,
        pytest.param(random_blend(6), marks=pytest.mark.slow),
    ],
    ids=["one", "blend", "angle"],
)
def test_normals_follow_their_density(ndf):
    normals = np.asarray(_normal(ndf, POINTS))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-13)
    assert p_value(normals, upper(lambda at: _normal_pdf(ndf, at))) > REJECTION


@pytest.mark.parametrize("light", [pytest.param("high", marks=pytest.mark.slow), "grazing"])
@pytest.mark.parametrize(
    "ndf", [PROFILE, pytest.param(BLEND, marks=pytest.mark.slow)], ids=["one", "blend"]
)
def test_visible_normals_follow_their_density(ndf, light):
    outgoing = OUTGOING[light]
    normals = np.asarray(_visible(ndf, outgoing, POINTS))
    # A normal at the rim of what is visible may be hidden by rounding.
    assert (normals @ np.asarray(outgoing)).min() > -1e-7
    assert p_value(normals, upper(lambda at: _visible_pdf(ndf, outgoing, at))) > REJECTION


@pytest.mark.slow
@pytest.mark.parametrize("theta_o", [0.2, 0.9, 1.4, 1.55])
@pytest.mark.parametrize("ndf", [PROFILE, BLEND], ids=["one", "blend"])
def test_many_visible_normals_follow_their_density(ndf, theta_o):
    outgoing = direction(theta_o, 0.7)
    points = np.random.default_rng(8).random((60_000, 2))
    normals = np.asarray(_visible(ndf, outgoing, points))
    assert p_value(normals, upper(lambda at: _visible_pdf(ndf, outgoing, at))) > REJECTION


@pytest.mark.slow
@pytest.mark.parametrize("ndf", [PROFILE, BLEND], ids=["one", "blend"])
def test_reflections_follow_their_density(ndf):
    outgoing = OUTGOING["high"]
    incoming = np.asarray(_reflection(ndf, outgoing, POINTS))
    assert p_value(incoming, lambda at: _reflection_pdf(ndf, outgoing, at)) > REJECTION


@pytest.mark.slow
def test_wrong_densities_are_rejected():
    outgoing = OUTGOING["grazing"]
    normals = np.asarray(_visible(BLEND, outgoing, POINTS))
    swapped = Blend(BLEND.y, BLEND.x)
    assert p_value(normals, upper(lambda at: _visible_pdf(swapped, outgoing, at))) < 1e-9
    assert p_value(normals, upper(lambda at: _normal_pdf(BLEND, at))) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("variable", ["angle", "cos2"])
def test_polar_angles_invert_their_cdf(variable):
    ndf = random_profile(3, 6, variable)
    samples = np.concatenate([[0.0, 1e-12, 1 - 1e-12], np.linspace(0.01, 0.99, 40)])
    theta = jax.vmap(lambda each: sample_polar_angle(ndf, each))(samples)
    np.testing.assert_allclose(mass_below(ndf, theta), samples, atol=1e-14)
    # In float32 it ends as well: the number of steps is fixed.
    narrow = Profile(
        *(jnp.asarray(each, jnp.float32) for each in (ndf.knots, ndf.values)), variable
    )
    drawn = jax.vmap(lambda each: sample_polar_angle(narrow, each))(jnp.float32(samples))
    np.testing.assert_allclose(mass_below(ndf, np.asarray(drawn, float)), samples, atol=2e-6)


def test_azimuths_invert_their_cdf():
    samples = np.concatenate([[0.0, 0.25, 0.5], np.linspace(0.003, 0.997, 60)])
    for sign in (1.0, -1.0):
        phi = np.asarray(jax.vmap(sample_azimuth, (None, 0))(sign, samples))
        np.testing.assert_allclose(
            phi / (2 * np.pi) + sign * np.sin(2 * phi) / (4 * np.pi), samples, atol=1e-14
        )
    # The mixture of both is Eq. 7.
    phi = np.arctan2(*np.asarray(_normal(BLEND, POINTS)).T[1::-1]) % (2 * np.pi)
    cdf = np.asarray(azimuth_cdf(BLEND, np.sort(phi)))
    steps = np.arange(len(cdf)) / len(cdf)
    assert np.abs(cdf - steps).max() < 2 / np.sqrt(len(cdf))


@pytest.mark.slow
def test_segments_without_normals_are_never_drawn():
    ndf = normalised(
        profile(
            np.array([0, 0.3, 0.5, 0.9, 1.2, np.pi / 2]), np.array([0.0, 0, 1, 0, 0, 0]), "cos2"
        )
    )
    samples = np.linspace(0, 1 - 1e-9, 50)
    theta = np.asarray(jax.vmap(lambda each: sample_polar_angle(ndf, each))(samples))
    assert theta.min() >= 0.3 - 1e-12
    assert theta.max() <= 0.9 + 1e-12


@pytest.mark.slow
def test_samples_are_differentiable():
    sample = jnp.array([0.3, 0.6])

    def drawn(values):
        return sample_visible_normal(
            Profile(PROFILE.knots, values, "cos2"), OUTGOING["high"], sample
        )

    moved = jax.jit(jax.jacfwd(drawn))(PROFILE.values)
    step = np.zeros(7)
    step[2] = 1e-5
    expected = (drawn(PROFILE.values + step) - drawn(PROFILE.values - step)) / 2e-5
    np.testing.assert_allclose(moved[:, 2], expected, atol=1e-8)


def test_the_root_of_an_increasing_function():
    def cubic(x, scale):
        return scale * x**3, 3 * scale * x * x

    x = increasing_root(cubic, 2.0, 0.25, 0.0, 1.0)
    np.testing.assert_allclose(x, 0.5, rtol=1e-15)
    slope = jax.grad(lambda goal: increasing_root(cubic, 2.0, goal, 0.0, 1.0))(0.25)
    np.testing.assert_allclose(slope, 1 / 1.5, rtol=1e-14)
    # A triple root, to which each step of Newton takes away a third of the distance.
    assert increasing_root(cubic, 1.0, 0.0, -1.0, 2.0) < 1e-6


@pytest.mark.slow
def test_the_visible_area_at_the_normal_is_one():
    np.testing.assert_allclose(visible_area(BLEND, jnp.array([0.0, 0.0, 1.0])), 1, rtol=1e-14)


def test_visible_normals_need_the_closed_form():
    with pytest.raises(ValueError, match="'cos2' only"):
        sample_visible_normal(random_profile(1), OUTGOING["high"], POINTS[0])
