"""The sphere of any isotropic NDF: that of a fit is that of what it stands for."""

import jax.numpy as jnp
import numpy as np
import pytest

from quantities.piecewise.fit import fit_ndf
from quantities.piecewise.targets import analytic_ndf
from shadefit.render.microfacet_sphere import (
    ggx_microfacets,
    lit_sphere,
    piecewise_microfacets,
)
from shadefit.render.scenes import SCENES
from shadefit.render.shade import BACKDROP
from shading.microfacet import ggx
from tests.integrals.piecewise_examples import random_profile

WHITE = (1.0, 1.0, 1.0)
LAMP = (((-0.4, -0.8, 0.6), (1.0, 1.0, 1.0)),)


@pytest.mark.slow
def test_single_scattering_is_the_brdf_times_the_cosine():
    image = lit_sphere(ggx_microfacets(0.4), WHITE, size=16, multiple=False, lamps=LAMP)
    hits = SCENES["sphere"].hits(16)
    axis = np.array(LAMP[0][0]) / np.linalg.norm(LAMP[0][0])
    checked = 0
    for k in np.nonzero(hits.seen)[0]:
        # A frame whose z axis is the normal.
        normal = hits.normal[k]
        x = np.cross([0.3, 0.2, 0.9], normal)
        x /= np.linalg.norm(x)
        frame = np.stack([x, np.cross(normal, x), normal])
        light, view = frame @ axis, frame @ hits.view[k]
        if light[2] > 0.05 and view[2] > 0.05:
            expected = float(ggx.brdf(jnp.asarray(view), jnp.asarray(light), 0.4)) * light[2]
            np.testing.assert_allclose(image.reshape(-1, 3)[k], expected, rtol=1e-9)
            checked += 1
    assert checked > 50


@pytest.mark.slow
def test_a_fit_looks_like_ggx_with_all_scattering():
    truth = ggx_microfacets(0.4)
    fitted = piecewise_microfacets(fit_ndf(analytic_ndf("ggx:0.4"), 16).profile)
    # Measured: 6e-3 of 0.9 for the image, 1.2e-5 for E.
    first, second = (lit_sphere(each, WHITE, size=48) for each in (truth, fitted))
    assert np.abs(first - second).max() < 0.012
    np.testing.assert_allclose(fitted.albedos, truth.albedos, atol=5e-5)
    assert abs(fitted.average - truth.average) < 1e-5
    dark = lit_sphere(fitted, WHITE, size=48, multiple=False)
    seen = ~np.all(second == BACKDROP, axis=-1)
    # E_avg is 0.77: single scattering loses a quarter of the energy of white light.
    assert 0.7 < dark[seen].sum() / second[seen].sum() < 0.95
    assert (second[seen] >= dark[seen] - 1e-12).all()


def test_the_sphere_needs_the_closed_form():
    with pytest.raises(ValueError, match="'cos2' only"):
        piecewise_microfacets(random_profile(1))
