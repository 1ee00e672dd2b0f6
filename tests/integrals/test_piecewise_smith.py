"""Λ, G1 and G2 of the piecewise-linear NDF: closed form, quadrature, 30 digits, the definition."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals.piecewise.smith import (
    hidden_area,
    hidden_area_of,
    hidden_area_quadrature,
    smith_g1,
    smith_g2,
    smith_lambda,
)
from shading.piecewise.hidden_area import hidden_area_closed
from shading.piecewise.moments import moment, normalised
from shading.piecewise.ndf import VARIABLES, Profile, density
from tests.integrals.piecewise_examples import (
    area_by_definition,
    exact_hidden_area,
    gauss,
    random_blend,
    random_profile,
    sampled,
    values_of,
)

ANGLES = np.array([1e-6, 1e-3, 0.4, 1.0, 1.5, 1.57, np.pi / 2])
# Relative, of H. 7e-16 was measured for the quadrature.
QUADRATURE, CLOSED = 4e-15, 8e-15

_quadrature = jax.jit(jax.vmap(hidden_area_quadrature, (None, 0)))
_closed = jax.jit(jax.vmap(hidden_area_closed, (None, 0)))
_g1 = jax.jit(jax.vmap(smith_g1, (None, 0)))


@pytest.mark.parametrize("variable", VARIABLES)
def test_the_hidden_area_is_exact(variable):
    ndf = random_profile(3, 4, variable)
    exact = np.array([float(exact_hidden_area(ndf, each)) for each in ANGLES])
    np.testing.assert_allclose(_quadrature(ndf, ANGLES), exact, rtol=QUADRATURE)
    if variable == "cos2":
        np.testing.assert_allclose(_closed(ndf, ANGLES), exact, rtol=CLOSED)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["ggx", "beckmann"])
def test_a_narrow_ndf_loses_no_digits(kind):
    """Each knot adds an area of full relative precision; sums over segments lose four digits."""
    ndf = normalised(sampled(kind, 0.1, 90, "cos2"))
    angles = np.concatenate([np.linspace(0.3, 1.5, 30), np.pi / 2 - np.geomspace(1e-6, 0.05, 20)])
    # 2e-15 was measured for GGX against 30 digits, 6e-15 for Beckmann's NDF, whose bends differ in
    # sign.
    limit = {"ggx": 4e-15, "beckmann": 2e-14}[kind]
    found, wanted = _closed(ndf, angles), _quadrature(ndf, angles)
    # Areas below 1e-25 are those of Beckmann's tail, which is the rounding of its exponential.
    np.testing.assert_allclose(found, wanted, rtol=limit, atol=1e-25)


@pytest.mark.parametrize(
    ("theta_o", "phi_o"), [pytest.param(0.3, 0.0, marks=pytest.mark.slow), (1.4, 2.0)]
)
def test_a_blend_has_the_area_of_the_definition(theta_o, phi_o):
    for variable in VARIABLES:
        ndf = random_blend(6, 5, variable)
        exact = area_by_definition(ndf, theta_o, phi_o, "hidden")
        # The product rule itself is good to 1e-14 of H and 3e-16 of ∫ |o·m| D.
        np.testing.assert_allclose(hidden_area(ndf, theta_o, phi_o), exact, rtol=1e-13, atol=1e-15)


@pytest.mark.slow
def test_the_area_of_any_isotropic_ndf():
    ndf = random_profile(9)
    found = hidden_area_of(lambda theta: density(ndf, theta), 1.1, ndf.knots)
    np.testing.assert_allclose(found, hidden_area(ndf, 1.1), rtol=1e-15)

    def ggx(theta):
        return 0.3**2 / (jnp.pi * (0.3**2 * jnp.cos(theta) ** 2 + jnp.sin(theta) ** 2) ** 2)

    breaks = np.concatenate([[0], np.geomspace(0.05, np.pi / 2, 12)])
    for theta_o in (0.2, 0.9, 1.5):
        known = (np.sqrt(1 + (0.3 * np.tan(theta_o)) ** 2) - 1) / 2 * np.cos(theta_o)
        np.testing.assert_allclose(hidden_area_of(ggx, theta_o, breaks), known, rtol=1e-12)


@pytest.mark.parametrize("variable", [pytest.param("angle", marks=pytest.mark.slow), "cos2"])
def test_masking_is_between_zero_and_one_on_the_whole_domain(variable):
    """H ≥ 0 is proven in docs/piecewise-ndf.md; rounding does not break it either."""
    angles = np.concatenate(
        [
            np.linspace(0, np.pi / 2, 400),
            np.geomspace(1e-12, 1, 60),
            np.pi / 2 - np.geomspace(1e-12, 1, 60),
        ]
    )
    for ndf in (
        random_profile(1, 10, variable),
        normalised(sampled("beckmann", 0.05, 10, variable)),
        normalised(sampled("ggx", 0.1, 10, variable)),
    ):
        g1 = np.asarray(_g1(ndf, angles))
        inside = angles < np.pi / 2
        assert np.all(g1[inside] > 0)
        assert np.all(g1 <= 1)
        assert np.all(g1[~inside] < 1e-14)


@pytest.mark.slow
def test_grazing_light_sees_the_moment():
    ndf = random_profile(2, 6, "cos2")
    np.testing.assert_allclose(hidden_area(ndf, np.pi / 2), 2 * moment(ndf), rtol=1e-14)
    np.testing.assert_allclose(
        hidden_area(random_profile(2), np.pi / 2), 2 * moment(random_profile(2)), rtol=1e-14
    )


def test_the_slopes_give_the_same_lambda():
    """μΛ = ∫ (q − μ) P₂(q) dq from μ = cot θo on; from −∞ on it would be −μ (Eq. 32)."""
    ndf, theta_o = random_profile(7, 6, "cos2"), 0.8
    mu = 1 / np.tan(theta_o)
    theta, w = gauss(np.asarray(ndf.knots), 60)
    phi = (np.arange(4000) + 0.5) * 2 * np.pi / 4000
    # P₂(q) dq integrated over slopes is D cos θ integrated over normals, with q = −tan θ cos φ.
    q = np.tan(theta)[:, None] * np.cos(phi)
    measure = (
        (w * values_of(ndf, theta) * np.cos(theta) * np.sin(theta))[:, None] * 2 * np.pi / 4000
    )
    above = np.sum(np.maximum(q - mu, 0) * measure) / mu
    everything = np.sum((q - mu) * measure) / mu
    np.testing.assert_allclose(smith_lambda(ndf, theta_o), above, rtol=1e-4)
    np.testing.assert_allclose(everything, -1, rtol=1e-12)


def test_g2_is_finite_everywhere_and_symmetric():
    ndf = random_blend(4, 5, "cos2")
    first, second = (0.7, 1.2), (0.4, 2.1)
    g2 = smith_g2(ndf, *first, *second)
    np.testing.assert_allclose(g2, smith_g2(ndf, *first[::-1], *second[::-1]), rtol=1e-15)
    lambdas = [smith_lambda(ndf, t, p) for t, p in zip(first, second, strict=True)]
    np.testing.assert_allclose(g2, 1 / (1 + lambdas[0] + lambdas[1]), rtol=1e-14)
    assert 0 <= smith_g2(ndf, np.pi / 2, np.pi / 2) < 1e-14
    assert smith_g2(ndf, 0.0, 0.0) == 1


@pytest.mark.slow
def test_derivatives_are_finite_and_right():
    ndf = random_profile(5, 6, "cos2")
    slope = jax.jit(jax.vmap(jax.grad(lambda t: hidden_area(ndf, t))))
    angles = jnp.array([0.0, 0.2, 0.9, 1.5, np.pi / 2])
    assert np.isfinite(slope(angles)).all()
    step = 1e-5
    expected = (_closed(ndf, angles[1:4] + step) - _closed(ndf, angles[1:4] - step)) / (2 * step)
    np.testing.assert_allclose(slope(angles)[1:4], expected, rtol=1e-7)
    # Λ is linear in the values: its gradient times them is itself.
    gradient = jax.grad(lambda values: hidden_area(Profile(ndf.knots, values, "cos2"), 1.0))
    values = ndf.values
    np.testing.assert_allclose(gradient(values) @ values, hidden_area(ndf, 1.0), rtol=1e-13)
    blend = random_blend(5, 5)
    assert np.isfinite(jax.grad(lambda t: hidden_area(blend, t, 0.4))(jnp.array(0.8)))


def test_the_closed_form_is_for_cos2_only():
    with pytest.raises(ValueError, match="'cos2' only"):
        hidden_area_closed(random_profile(1), 0.3)
