"""The directional albedo of a piecewise-linear NDF: convergence, Monte Carlo, and known GGX."""

import jax
import numpy as np
import pytest

from integrals.piecewise.albedo import average_albedo, directional_albedo
from quantities.piecewise.knots import equidistributed_knots
from quantities.piecewise.targets import analytic_ndf
from shading import direction
from shading.microfacet.kulla_conty import multiple_scattering
from shading.piecewise.hidden_area import hidden_area_closed
from shading.piecewise.moments import normalised
from shading.piecewise.ndf import profile
from shading.piecewise.visible_sampling import sample_reflection
from tests.integrals.piecewise_examples import random_profile

NDF = random_profile(3, 6, "cos2")
# E(μ, α) of GGX with the height-correlated G2, from mpmath.
GGX = {(0.25, 0.3): 0.837905764575236, (0.5, 0.5): 0.698250696927548}

_albedo = jax.jit(directional_albedo, static_argnames="nodes")


@pytest.mark.parametrize("theta_o", [0.2, 1.4])
@pytest.mark.slow
def test_the_albedo_converges(theta_o):
    fine = float(_albedo(NDF, theta_o, nodes=24))
    assert abs(float(_albedo(NDF, theta_o)) - fine) < 1e-8
    assert 0 < fine < 1


@pytest.mark.slow
def test_the_albedo_is_the_mean_of_reflections():
    """f ν/pdf = ν(μ + H(o))/(μν + H(o)ν + H(i)μ) for the sampler of visible normals."""
    theta_o, points = 0.9, np.random.default_rng(5).random((20_000, 2))
    outgoing = direction(theta_o, 0.0)
    drawn = jax.jit(jax.vmap(lambda point: sample_reflection(NDF, outgoing, point)))(points)
    nu = np.maximum(np.asarray(drawn)[:, 2], 0)
    area = jax.jit(jax.vmap(lambda at: hidden_area_closed(NDF, at)))
    mu, own, other = np.cos(theta_o), float(hidden_area_closed(NDF, theta_o)), area(np.arccos(nu))
    weights = nu * (mu + own) / np.maximum(mu * nu + own * nu + np.asarray(other) * mu, 1e-300)
    error = weights.std() / np.sqrt(len(weights))
    assert abs(weights.mean() - float(_albedo(NDF, theta_o))) < 5 * error


@pytest.mark.slow
@pytest.mark.parametrize("case", GGX)
def test_the_albedo_of_a_fitted_ggx_approaches_that_of_ggx(case):
    width, mu = case
    target = analytic_ndf(f"ggx:{width}")
    knots = equidistributed_knots(target.of, 16)
    ndf = normalised(profile(knots, target.of(knots), "cos2"))
    # 3.4e-4 and 2.9e-4 were measured; four times less with twice the segments.
    assert abs(float(_albedo(ndf, np.arccos(mu))) - GGX[case]) < 5e-4


@pytest.mark.slow
def test_kulla_and_conty_return_what_is_lost():
    """In a furnace with F = 1, f_ms adds 1 − E(o): E_avg is the average of this E."""
    average = float(average_albedo(NDF))
    # Lights by another rule than that of the average: midpoints in ν.
    nu = (np.arange(60) + 0.5) / 60
    albedos = np.array([float(_albedo(NDF, each)) for each in np.arccos(nu)])
    own = float(_albedo(NDF, 1.0))
    added = [float(multiple_scattering(own, each, average)) for each in albedos]
    np.testing.assert_allclose(2 * np.pi * np.mean(nu * added), 1 - own, rtol=2e-3)


@pytest.mark.slow
def test_the_average_and_the_derivative():
    coarse, fine = (float(average_albedo(NDF, nodes=each)) for each in (24, 48))
    assert abs(coarse - fine) < 1e-5
    slope = jax.grad(lambda at: directional_albedo(NDF, at))(0.9)
    step = 1e-5
    expected = (_albedo(NDF, 0.9 + step) - _albedo(NDF, 0.9 - step)) / (2 * step)
    np.testing.assert_allclose(slope, expected, rtol=1e-5)


def test_the_albedo_needs_the_closed_form():
    with pytest.raises(ValueError, match="'cos2' only"):
        directional_albedo(random_profile(1), 0.5)
