"""Samplers of GGX: their densities, their rejections, the horizon, and the bound of the cap."""

import jax
import numpy as np
import pytest

from shading.microfacet.ggx import projected_roughness
from shading.microfacet.horizon import horizon_bound, horizon_height
from shading.microfacet.reflection_cone import components
from shading.microfacet.sampling import (
    cap_bound,
    reflection_density,
    sample_upper,
)
from tests.shading.microfacets import (
    SAMPLERS,
    areas,
    distribution,
    drawn,
    p_value,
    view_of,
)

# Probability that a correct sampler is rejected. The seeds are fixed: results are reproducible.
REJECTION = 1e-4
# (θ, φ) of the view in degrees, αx, αy
FEW = [(60, 0, 0.5, 0.5), (60, 40, 1.0, 0.3)]
MANY = [*FEW, (0, 0, 0.3, 0.3), (5, 0, 0.2, 0.8), (85, 10, 0.25, 0.25), (85, 70, 0.6, 0.15)]
MANY += [(89.9, 30, 0.5, 1.0), (30, 200, 2.0, 0.4)]


def check(name, setting, count, mirrored=True) -> float:
    """Return the p-value of a sampler.

    The lights of the first two are those with h·n > 0, which is i·n > −o·n, on either side of the
    horizon. Those of the others are compared on the hemisphere.
    """
    theta, phi, *alphas = setting
    view, (_, field, numbers) = view_of(theta, phi), SAMPLERS[name]
    random = np.random.default_rng(11).random((count, numbers))
    if not mirrored:
        # With a third number of zero the point of the disk is never replaced by its mirror image.
        random[:, 2] = 0
    lights = drawn(name, view, alphas, random)
    np.testing.assert_allclose(np.linalg.norm(lights, axis=1), 1, rtol=1e-13)
    area = getattr(areas(view, np.array(alphas)), field)
    lowest = -view[2] if field == "visible" else 0.0
    return p_value(lights, view, alphas, float(area), lowest)


@pytest.mark.parametrize("setting", FEW)
@pytest.mark.parametrize("name", SAMPLERS)
def test_lights_follow_their_density(name, setting):
    assert check(name, setting, 200_000) > REJECTION


@pytest.mark.slow
@pytest.mark.parametrize("setting", MANY)
@pytest.mark.parametrize("name", SAMPLERS)
def test_many_lights_follow_their_density(name, setting):
    assert check(name, setting, 1_000_000) > REJECTION


@pytest.mark.parametrize("setting", FEW)
def test_without_the_mirror_image_the_density_is_wrong(setting):
    assert check("upper", setting, 200_000, mirrored=False) < 1e-100


def any_settings(count: int, lowest: float, seed: int):
    """Return views (n, 3) with θ up to 89.9°, and roughnesses from `lowest` to 1."""
    rng = np.random.default_rng(seed)
    theta = np.concatenate([rng.uniform(0, 89.9, count // 2), np.full(count - count // 2, 89.9)])
    views = np.stack(
        [view_of(*each) for each in zip(theta, rng.uniform(0, 360, count), strict=True)]
    )
    alphas = 10 ** rng.uniform(np.log10(lowest), 0, (2, count))
    # Some at the ends, and some isotropic
    alphas[:, ::7], alphas[:, 3::7] = lowest, 1.0
    alphas[0, 5::7] = alphas[1, 5::7]
    return views, alphas.T


def below_the_horizon(dtype, per_setting: int, count: int) -> int:
    rng, lost = np.random.default_rng(12), 0
    views, alphas = any_settings(count, 0.01, 13)
    numbers = rng.random((per_setting, 3), dtype=dtype)
    # The largest numbers below one are the hardest.
    numbers[: per_setting // 10, 0] = 1 - np.finfo(dtype).eps / 2
    for view, both in zip(views, alphas, strict=True):
        lights = drawn("upper", view, both, numbers)
        assert lights.dtype == dtype
        assert np.isfinite(lights).all()
        lost += int(np.sum(lights[:, 2] <= 0))
    return lost


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_no_light_is_below_the_horizon(dtype):
    assert below_the_horizon(dtype, 25_000, 40) == 0


@pytest.mark.slow
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_of_ten_million_lights_none_is_below_the_horizon(dtype):
    assert below_the_horizon(dtype, 100_000, 100) == 0


@pytest.mark.parametrize("name", ["cap", "bounded cap"])
def test_the_other_samplers_do_lose_lights(name):
    """The counts agree with the closed forms of the accepted fractions within five deviations."""
    count, (_, field, numbers) = 50_000, SAMPLERS[name]
    random = np.random.default_rng(14).random((count, numbers))
    for theta, phi, *alphas in MANY:
        view = view_of(theta, phi)
        area = areas(view, np.array(alphas))
        accepted = float(area.upper / getattr(area, field))
        share = np.mean(drawn(name, view, alphas, random)[:, 2] > 0)
        assert abs(share - accepted) < 5 * np.sqrt(accepted * (1 - accepted) / count) + 1e-9
        assert accepted < 1 + 1e-14


def rejected(theta, alpha) -> tuple[float, float]:
    """Return the rejected fractions of all visible normals, and of the bounded cap."""
    area = areas(view_of(theta, 25), np.array([alpha, alpha]))
    return float(1 - area.upper / area.visible), float(1 - area.upper / area.bounded)


def test_rejected_fractions_by_hand():
    for alpha in (0.01, 0.3, 1.0):
        whole, bounded = rejected(0, alpha)
        np.testing.assert_allclose(whole, alpha**2 / (1 + alpha**2), rtol=1e-11)
        assert abs(bounded) < 1e-14
    for theta in (10, 60, 89):
        mu = np.cos(np.radians(theta))
        whole, bounded = rejected(theta, 1.0)
        np.testing.assert_allclose(whole, mu / (1 + mu), rtol=1e-13)
        assert abs(bounded) < 1e-14


@pytest.mark.parametrize("setting", [(30, 0, 0.3, 0.3), (70, 40, 0.2, 0.8)])
def test_densities_integrate_to_one_over_the_hemisphere(setting):
    """Gauss–Legendre in θ and trapezoid in φ; the densities of the others are 1 with their lost."""
    theta, phi, *alphas = setting
    view = view_of(theta, phi)
    x, weights = np.polynomial.legendre.leggauss(256)
    polar, azimuth = (x + 1) * np.pi / 4, np.arange(1024) * 2 * np.pi / 1024
    polar, azimuth = polar[:, None], azimuth[None, :]
    lights = np.stack(
        [
            np.sin(polar) * np.cos(azimuth),
            np.sin(polar) * np.sin(azimuth),
            np.cos(polar) + 0 * azimuth,
        ],
        axis=-1,
    )
    values = distribution(lights + view, alphas)
    measure = (weights * np.pi / 4)[:, None] * np.sin(polar) * 2 * np.pi / 1024
    found = areas(view, np.array(alphas))
    for area in found:
        total = np.sum(reflection_density(1.0, area) * values * measure)
        np.testing.assert_allclose(total, found.upper / area, rtol=1e-10)


def test_horizon_is_that_of_the_definition():
    """Reflect ẑ about the image of the half vector, without the algebra of `horizon_bound`."""
    rng = np.random.default_rng(15)
    for theta, phi, *alphas in MANY:
        view, scale = view_of(theta, phi), np.array([*alphas, 1.0])
        longitude = rng.uniform(-np.pi, np.pi)
        half = (view + np.array([np.cos(longitude), np.sin(longitude), 0])) / scale
        half /= np.linalg.norm(half)
        stretched = view * scale / np.linalg.norm(view * scale)
        height = 2 * (half @ stretched) * half[2] - stretched[2]
        found = horizon_height(view, np.array(alphas), longitude)
        np.testing.assert_allclose(found, height, atol=1e-14)


bounds = jax.jit(
    jax.vmap(jax.vmap(horizon_bound, (None, None, 0)), (0, 0, None)),
)
published = jax.jit(jax.vmap(lambda view, alpha: cap_bound(*components(view, alpha))))


def settings_and_largest(seed: int, isotropic: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the published k and the largest k(φ) of 3000 settings, α from 0.01 to 5.

    The azimuths are 512, and that of the view, where an isotropic k(φ) is largest or least.
    """
    rng = np.random.default_rng(seed)
    count = 3000
    azimuth = np.pi / 256 * rng.integers(0, 512, count)
    angles = zip(rng.uniform(0, 89.9, count), np.degrees(azimuth), strict=True)
    views = np.stack([view_of(*each) for each in angles])
    alphas = 10 ** rng.uniform(-2, np.log10(1.0 if isotropic else 5.0), (2, count))
    if isotropic:
        alphas[1] = alphas[0]
    largest = bounds(views, alphas.T, np.arange(512) * np.pi / 256).max(axis=1)
    return np.asarray(published(views, alphas.T)), np.asarray(largest)


def test_bound_of_an_isotropic_cap_is_tight():
    given, largest = settings_and_largest(16, isotropic=True)
    np.testing.assert_allclose(given, largest, rtol=0, atol=1e-12)


def test_bound_of_an_anisotropic_cap_is_never_violated():
    given, largest = settings_and_largest(17, isotropic=False)
    assert np.all(given >= largest - 1e-12)
    # It is not tight there: a smaller cap would do.
    assert np.max(given - largest) > 0.05


def test_lights_have_finite_derivatives():
    """Two eigenvalues are equal at normal incidence, and one is zero at grazing views."""
    places = [(60, 40, 0.4, 0.7), (0, 0, 0.4, 0.4), (5, 90, 0.2, 0.8), (90, 0, 0.3, 0.6)]
    points = np.array([[*view_of(t, p), a, b, 0.3, 0.7, 0.2] for t, p, a, b in places])

    def light(point):
        return sample_upper(point[:3], point[3:5], point[5:])

    slopes = jax.jit(jax.vmap(jax.jacfwd(light)))(points)
    assert np.isfinite(slopes).all()
    lights, step = jax.jit(jax.vmap(light)), 1e-6
    for index in (0, 1, 3, 4, 5, 6):
        shift = step * np.eye(8)[index]
        rate = (lights(points + shift) - lights(points - shift)) / (2 * step)
        np.testing.assert_allclose(slopes[:, :, index], rate, atol=1e-4)


def test_a_view_below_the_surface_has_lights_above_its_mirror_image():
    """`sample_cap` and `sample_bounded_cap` are the same there, and lights follow D(h)/(4N)."""
    view, alphas = view_of(130, 20), (0.5, 0.3)
    random = np.random.default_rng(18).random((100_000, 2))
    lights = drawn("cap", view, alphas, random)
    np.testing.assert_array_equal(lights, drawn("bounded cap", view, alphas, random))
    area = float(projected_roughness(view, np.array(alphas)) + view[2]) / 2
    assert p_value(lights, view, alphas, area, -view[2]) > REJECTION
