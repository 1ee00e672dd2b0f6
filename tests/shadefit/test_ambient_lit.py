"""The corrected ambient layer at the materials and views that judge the ambient model."""

import jax
import numpy as np
import pytest

from integrals import PS, G
from shadefit.ambient.lights import lights
from shadefit.ambient.radiances import EXACT, materials_and_views, radiances
from shading import ambient_layer_lit, direction_cosines, mean_radiance

# The rms errors in docs/ambient-light.md, relative to the mean.
STATED = (0.044, 0.151, 0.523, 0.188, 0.444)


@pytest.mark.slow
def test_stated_errors_of_the_corrected_layer():
    """None of these points was fitted."""
    points = materials_and_views()
    mean = mean_radiance(np.stack(list(lights().values()), axis=1), np.array([0.0, 0.0, 1.0]))

    def layer(alpha, theta_f, density, theta_v, phi):
        cos_v, cos_vt = direction_cosines(theta_f, theta_v, jax.numpy.cos(phi))
        scattered = PS.value(alpha, theta_f, theta_v, phi)
        scattering, cos_nt = G.value(density, cos_v), jax.numpy.cos(theta_f)
        return ambient_layer_lit(mean, 1.0, scattering, scattered, cos_vt, cos_nt, alpha)

    exact = radiances(points, (EXACT,)).exact["layer"]
    error = np.asarray(jax.jit(jax.vmap(layer))(*points.T)) - exact
    rms = np.sqrt(np.mean(error**2, axis=0)) / exact.mean(axis=0)
    np.testing.assert_allclose(rms, STATED, rtol=0, atol=6e-4)
