"""The scale of the reciprocal phase function: two solutions of its equation, energy, limits."""

import numpy as np
import pytest

from integrals.fuzz.phase_scale import reciprocal_energy, scale_by_cosines, scale_by_normals

COSINES = np.array([0.0, 0.3, 0.8, 0.95, 1.0])


# The rule over visible normals needs more of them for a smaller α.
@pytest.mark.parametrize(("alpha", "tolerance"), [(0.2236, 1e-4), (0.447, 1e-8), (0.8, 1e-13)])
def test_both_methods_agree(alpha, tolerance):
    one, other = scale_by_cosines(alpha)(COSINES), scale_by_normals(alpha)(COSINES)
    np.testing.assert_allclose(one, other, rtol=tolerance)


@pytest.mark.parametrize("alpha", [0.05, 0.3, 0.9])
def test_energy_is_one_and_the_scale_is_even(alpha):
    scale = scale_by_cosines(alpha)
    for cosine in (-0.77, 0.13, 1.0):
        assert abs(reciprocal_energy(alpha, cosine, scale) - 1) < 1e-9
    np.testing.assert_array_equal(scale(-COSINES), scale(COSINES))


def test_known_values():
    """s/σ at a = 0 and 1; more collocation points give the same digits."""
    for alpha, ends in ((0.447, (1.035069, 1.218263)), (0.7071, (1.037267, 1.067586))):
        values = scale_by_cosines(alpha, 30)(np.array([0.0, 1.0])) / [1, alpha]
        np.testing.assert_allclose(values, ends, rtol=1e-6)


def test_geometric_mean_of_the_areas_loses_energy():
    """s = √σ(ω) makes p symmetric, but it loses up to a third of the light along the fibre."""
    alpha = 0.15

    def root(cos_t):
        return np.sqrt(np.sqrt(1 - (1 - alpha**2) * cos_t**2))

    assert 1.01 < reciprocal_energy(alpha, 0.0, root) < 1.02
    assert 0.67 < reciprocal_energy(alpha, 1.0, root) < 0.69


@pytest.mark.parametrize("alpha", [0.0, 1.0, -0.5, float("nan")])
def test_other_roughness_is_refused(alpha):
    for method in (scale_by_cosines, scale_by_normals):
        with pytest.raises(ValueError, match="above 0 and below 1"):
            method(alpha)
