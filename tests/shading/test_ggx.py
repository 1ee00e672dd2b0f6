"""GGX with Smith's masking: normalisations, reciprocity, and the forms of the masking."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals.microfacet import anisotropic_albedo, directional_albedo
from shading import direction
from shading.microfacet import (
    brdf,
    correlated_visibility,
    masking,
    masking_shadowing,
    ndf,
    projected_roughness,
    projected_roughness_at,
    smith_lambda,
    uncorrelated_visibility,
    visible_normal_density,
)

WIDTHS = [np.array([0.5, 0.5]), np.array([0.2, 0.8])]


def directions(nodes, least):
    """Return unit vectors (n, 3) with cosines from `least` to 1, and the weights of dω."""
    x, weights = np.polynomial.legendre.leggauss(nodes)
    cosine, weight = least + (1 - least) * (x + 1) / 2, (1 - least) / 2 * weights
    phi = 2 * np.pi * np.arange(2 * nodes) / (2 * nodes)
    sine = np.sqrt(1 - cosine**2)
    grid = np.stack(
        [
            np.outer(sine, np.cos(phi)),
            np.outer(sine, np.sin(phi)),
            np.outer(cosine, np.ones(len(phi))),
        ],
        axis=-1,
    )
    return grid.reshape(-1, 3), np.repeat(weight, len(phi)) * 2 * np.pi / len(phi)


@pytest.mark.parametrize("alpha", WIDTHS)
def test_facets_project_onto_the_surface(alpha):
    """∫ D (m·n) dω = 1, and ∫ D max(o·m, 0) dω = (μ + σ(o))/2, so the density integrates to 1."""
    normals, weights = directions(96, 0.0)
    density = jax.vmap(ndf, (0, None))(normals, alpha)
    np.testing.assert_allclose(weights @ (density * normals[:, 2]), 1, rtol=1e-7)
    for view in (direction(0.7, 0.4), direction(1.5, 2.0), direction(2.0, 1.0)):
        visible = jax.vmap(visible_normal_density, (0, None, None))(normals, view, alpha)
        # max(o·m, 0) has a kink, where the rule converges slowly.
        np.testing.assert_allclose(weights @ visible, 1, rtol=1e-3)


def test_no_facet_faces_down():
    assert ndf(np.array([0.6, 0.0, -0.8]), 0.5) == 0


def test_masking_has_the_forms_of_smith():
    view, light = direction(0.9, 0.3), direction(1.3, 2.0)
    for alpha in WIDTHS:
        to_view, to_light = smith_lambda(view, alpha), smith_lambda(light, alpha)
        np.testing.assert_allclose(masking(view, alpha), 1 / (1 + to_view), rtol=1e-14)
        np.testing.assert_allclose(
            masking_shadowing(view, light, alpha), 1 / (1 + to_view + to_light), rtol=1e-14
        )
        np.testing.assert_allclose(
            masking_shadowing(view, light, alpha, correlated=False),
            1 / ((1 + to_view) * (1 + to_light)),
            rtol=1e-14,
        )


def test_visibility_is_the_masking_without_cosines():
    view, light, alpha = direction(0.9, 0.3), direction(1.3, 2.0), 0.4
    np.testing.assert_allclose(
        projected_roughness_at(view[2], alpha), projected_roughness(view, alpha), rtol=1e-15
    )
    for visibility, correlated in ((correlated_visibility, True), (uncorrelated_visibility, False)):
        expected = masking_shadowing(view, light, alpha, correlated=correlated)
        np.testing.assert_allclose(
            4 * view[2] * light[2] * visibility(view[2], light[2], alpha), expected, rtol=1e-14
        )


def test_brdf_is_reciprocal_and_dark_below_the_horizon():
    rng = np.random.default_rng(0)
    both = jax.jit(lambda o, i, a: (brdf(o, i, a), brdf(i, o, a)))
    for theta in rng.uniform(0, np.pi / 2, (10, 2)):
        view, light = (direction(t, p) for t, p in zip(theta, rng.uniform(0, 6, 2), strict=True))
        there, back = both(view, light, WIDTHS[1])
        assert float(there) == pytest.approx(float(back), rel=1e-14)
        assert there > 0
    up, down = direction(0.3, 0.0), direction(np.pi - 0.3, np.pi)
    assert both(up, down, WIDTHS[1]) == (0, 0)
    slopes = jax.grad(lambda o, a: brdf(o, down, a), (0, 1))(up, WIDTHS[1])
    assert all(np.isfinite(each).all() for each in slopes)


def test_brdf_returns_the_directional_albedo():
    lights, weights = directions(96, 0.0)
    view = direction(np.arccos(0.6), 0.0)
    values = jax.jit(jax.vmap(brdf, (None, 0, None)))

    def total(alpha):
        return weights @ (values(view, lights, alpha) * lights[:, 2])

    even = np.array([0.5, 0.5])
    assert abs(total(even) - jax.jit(directional_albedo)(0.6, 0.5).value) < 1e-6
    uneven = np.array([0.4, 0.8])
    exact = jax.jit(lambda a: anisotropic_albedo(view, a, nodes=48, azimuths=128).value)(uneven)
    assert abs(total(uneven) - exact) < 1e-6


def test_derivatives_are_finite_at_normal_and_grazing_views():
    normal = jnp.array([0.0, 0.0, 1.0])
    level = jnp.array([1.0, 0.0, 0.0])
    for view in (normal, level):
        slopes = jax.grad(lambda o, a: brdf(o, normal, a), (0, 1))(view, WIDTHS[1])
        assert all(np.isfinite(each).all() for each in slopes)
