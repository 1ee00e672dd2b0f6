"""Visible normals of GGX and their rejections, compared with Mitsuba 3.

The tests are skipped without Mitsuba. `make toolchain-mitsuba` installs it.
"""

import numpy as np
import pytest

from tests.shading.microfacets import areas, distribution, drawn, view_of

mitsuba = pytest.importorskip("mitsuba")
mitsuba.set_variant("scalar_rgb")

SETTINGS = [(60, 0, (0.5, 0.5)), (5, 0, (0.2, 0.8)), (85, 70, (0.6, 0.15))]
SAMPLES = 20_000
# Mitsuba computes in float32; D is steep in the normal.
FLOAT32 = 1e-5


def facets(alphas):
    return mitsuba.MicrofacetDistribution(mitsuba.MicrofacetType.GGX, *alphas, True)


def vector(direction):
    return mitsuba.Vector3f(*map(float, direction))


@pytest.mark.parametrize("setting", SETTINGS, ids=str)
def test_densities_agree(setting):
    """The density of visible normals is D (o·m)/N with the N of `projected_areas`."""
    theta, phi, alphas = setting
    view, model = view_of(theta, phi), facets(alphas)
    area = float(areas(view, np.array(alphas)).visible)
    normals = np.random.default_rng(1).normal(size=(200, 3)) * [*alphas, 1.0]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True) * np.sign(normals[:, 2:])
    normals = np.asarray(normals, np.float32).astype(float)
    normals = normals[normals @ view > 0.01]
    theirs = [float(model.pdf(vector(view), vector(each))) for each in normals]
    ours = distribution(normals, alphas) * (normals @ view) / area
    np.testing.assert_allclose(theirs, ours, rtol=20 * FLOAT32)


def assert_same_moments(theirs, ours):
    """Compare means of components and of their squares by five of their standard errors."""
    for power in (1, 2):
        a, b = theirs**power, ours**power
        error = np.sqrt(a.var(axis=0) / len(a) + b.var(axis=0) / len(b))
        assert np.all(abs(a.mean(axis=0) - b.mean(axis=0)) < 5 * error)


@pytest.mark.slow
@pytest.mark.parametrize("setting", SETTINGS, ids=str)
def test_samples_agree(setting):
    """Rejections are as computed, and `sample_upper` draws their lights without the lost ones."""
    theta, phi, alphas = setting
    view, model = view_of(theta, phi), facets(alphas)
    numbers = np.random.default_rng(2).random((SAMPLES, 2))
    normals = np.array(
        [list(model.sample(vector(view), mitsuba.Point2f(*map(float, u)))[0]) for u in numbers]
    )
    theirs = 2 * (normals @ view)[:, None] * normals - view
    area = areas(view, np.array(alphas))
    lost = float(1 - area.upper / area.visible)
    assert abs(np.mean(theirs[:, 2] <= 0) - lost) < 5 * np.sqrt(lost * (1 - lost) / SAMPLES)
    random = np.random.default_rng(3).random((SAMPLES, 3))
    assert_same_moments(theirs, drawn("disk", view, alphas, random[:, :2]))
    assert_same_moments(theirs[theirs[:, 2] > 0], drawn("upper", view, alphas, random))
