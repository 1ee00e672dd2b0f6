"""Variances of samplers: two rules, Monte Carlo, albedos, and the table of docs."""

import jax
import numpy as np
import pytest

from integrals.microfacet.sampling_variance import (
    AZIMUTHS,
    NODES,
    isotropic_moments,
    moments,
    variances,
)
from tests.shading.microfacets import SAMPLERS, areas, drawn, view_of

# α or (αx, αy), θ and φ of the view in degrees; E; rejected fractions of all visible normals and of
# the bounded cap; variances of these two and of the upper normals. All digits are right.
TABLE = [
    (0.1, 0, 0, 0.988304, (0.0099, 0.0000), (0.01032, 0.00055, 0.00055)),
    (0.1, 60, 0, 0.969205, (0.0159, 0.0107), (0.01777, 0.01268, 0.00254)),
    (0.1, 85, 0, 0.886381, (0.0330, 0.0291), (0.04684, 0.04353, 0.01940)),
    (0.25, 60, 0, 0.857263, (0.0700, 0.0393), (0.07366, 0.04786, 0.01707)),
    (0.5, 0, 0, 0.687849, (0.2000, 0.0000), (0.15067, 0.02591, 0.02591)),
    (0.5, 30, 0, 0.683052, (0.1951, 0.0522), (0.14729, 0.05474, 0.02754)),
    (0.5, 60, 0, 0.698251, (0.1607, 0.0534), (0.13133, 0.06120, 0.03189)),
    (0.5, 85, 0, 0.872024, (0.0409, 0.0043), (0.05494, 0.02493, 0.02158)),
    (0.75, 60, 0, 0.564623, (0.2479, 0.0364), (0.15159, 0.04832, 0.03496)),
    (1.0, 0, 0, 0.306853, (0.5000, 0.0000), (0.13325, 0.01955, 0.01955)),
    (1.0, 60, 0, 0.450694, (0.3333, 0.0000), (0.14896, 0.03160, 0.03160)),
    (1.0, 89, 0, 0.929046, (0.0172, 0.0000), (0.02739, 0.01212, 0.01212)),
    ((0.2, 0.8), 5, 0, 0.621064, (0.2343, 0.2060), (0.16095, 0.14150, 0.03287)),
    ((1.0, 0.3), 60, 40, 0.595616, (0.2279, 0.1995), (0.15226, 0.13423, 0.03669)),
]
one_dimensional = jax.jit(isotropic_moments)
over_the_cone = jax.jit(moments, static_argnums=(2, 3))
variances_of = jax.jit(variances)


def setting(row):
    alpha, theta, phi = row[:3]
    return view_of(theta, phi), np.broadcast_to(np.asarray(alpha, float), (2,))


@pytest.mark.parametrize("row", TABLE, ids=str)
def test_table_of_rejections_and_variances(row):
    view, alphas = setting(row)
    found = over_the_cone(view, alphas, NODES, AZIMUTHS)
    area = areas(view, alphas)
    assert abs(found.albedo - row[3]) <= 0.5e-6
    rejected = [1 - area.upper / each for each in area[:2]]
    np.testing.assert_allclose(rejected, row[4], rtol=0, atol=0.501e-4)
    np.testing.assert_allclose(variances_of(view, alphas, found), row[5], rtol=0, atol=0.501e-5)
    if np.ndim(row[0]) == 0:
        other = one_dimensional(view[2], row[0])
        # Both rules are exact to some roundings of their sums.
        np.testing.assert_allclose(other, found, rtol=1e-12)


def test_anisotropic_samples_of_upper_normals_have_less_than_half_the_variance():
    for row in TABLE[-2:]:
        visible, bounded, upper = row[5]
        assert visible > bounded > 2 * upper


def test_albedos_of_the_rules_are_right():
    """The values are those of an adaptive rule in 30 digits."""
    for alpha, mu, exact in (
        (0.01, 0.5, 0.999742122599131),
        (0.05, 0.05, 0.889894054270654),
        (0.25, 0.3, 0.837905764575236),
        (1.0, 0.2, 0.641648106154389),
    ):
        view = np.array([np.sqrt(1 - mu * mu), 0, mu])
        found = over_the_cone(view, np.array([alpha, alpha]), NODES, AZIMUTHS)
        np.testing.assert_allclose(found.albedo, exact, rtol=2e-12)
        np.testing.assert_allclose(found, one_dimensional(mu, alpha), rtol=2e-12)
    for alphas, theta, phi, exact, tolerance in (
        ((0.2, 0.8), 60, 40, 0.663833520550, 1e-12),
        ((0.3, 0.6), 20, 10, 0.711515576482, 1e-12),
        ((0.05, 0.5), 85, 70, 0.919551381264, 4e-9),
    ):
        found = over_the_cone(view_of(theta, phi), np.array(alphas), NODES, AZIMUTHS)
        np.testing.assert_allclose(found.albedo, exact, rtol=tolerance)


@pytest.mark.parametrize("row", [TABLE[6], TABLE[-1]], ids=str)
@pytest.mark.parametrize("name", SAMPLERS)
def test_monte_carlo_has_this_mean_and_variance(name, row):
    """Both agree within five of their standard errors; that of the variance is estimated too."""
    count, (view, alphas), (_, field, numbers) = 200_000, setting(row), SAMPLERS[name]
    lights = drawn(name, view, alphas, np.random.default_rng(21).random((count, numbers)))
    area = getattr(areas(view, alphas), field)
    nu, sigma_o = np.maximum(lights[:, 2], 0), np.linalg.norm(view * [*alphas, 1.0])
    sigma_i = np.linalg.norm(lights * np.array([*alphas, 1.0]), axis=1)
    weights = np.asarray(2 * area * nu / (view[2] * sigma_i + nu * sigma_o))
    assert abs(weights.mean() - row[3]) < 5 * weights.std() / np.sqrt(count)
    squares = (weights - weights.mean()) ** 2
    expected = row[5][("visible", "bounded", "upper").index(field)]
    assert abs(squares.mean() - expected) < 5 * squares.std() / np.sqrt(count) + 0.5e-5
