"""Forms of E: the formula, what is built in, and that no coefficients create energy."""

import jax
import numpy as np
import pytest

from fitting import form_values
from fitting.linearity import linear_parts
from integrals import GGX_DIRECTIONAL_ALBEDO as E
from quantities.microfacet.albedo_forms import AXES, candidates, masked_albedo

NUMERATOR, DENOMINATOR = ((0, 1), (1, 0), (1, 3)), ((3, 0), (0, 3), (1, 2), (2, 4))
FORM = masked_albedo(numerator=NUMERATOR, denominator=DENOMINATOR)


def scattered(count: int, seed: int = 5) -> np.ndarray:
    rng = np.random.default_rng(seed)
    alpha = 10 ** (-2 * rng.random(count))
    mu = np.minimum(alpha * 10 ** rng.uniform(-3, 3, count), 1.0)
    return np.stack([mu, alpha], axis=1)


def by_definition(c, mu, alpha):
    """Return 2N/(μs + σ) with N = λ²/d, as it is written in papers: nothing is scaled."""
    kappa = 1 - alpha**2
    d = np.sqrt(kappa**2 * mu**2 + 4 * alpha**2)
    visible = ((kappa * mu + d) / 2) ** 2 / d
    sigma = np.sqrt(alpha**2 + kappa * mu**2)
    r = sum(ck * mu**i * alpha**j for ck, (i, j) in zip(c, NUMERATOR, strict=False))
    q = mu**3 + sum(
        ck * mu**i * alpha**j for ck, (i, j) in zip(c[3:], DENOMINATOR[1:], strict=True)
    )
    return 2 * visible / (mu * (1 + alpha**2 * r / q) + sigma)


def test_the_form_is_its_equation():
    at, c = scattered(200), np.array([0.2, 0.5, 3.0, 0.7, 2.0, 1.5])
    expected = by_definition(c, *at.T)
    np.testing.assert_allclose(form_values(FORM.fitted(c), at), expected, rtol=1e-12)


@pytest.mark.slow
def test_positive_coefficients_create_no_energy():
    at = np.concatenate([scattered(2000), [[0, 0.01], [1, 0.01], [0, 1], [1, 1]]])
    for seed in range(5):
        c = np.random.default_rng(seed).exponential(3.0, FORM.size)
        values = form_values(FORM.fitted(c), at)
        assert 0 < values.min() <= values.max() <= 1
        assert min(float(m) for p in at[:50] for m in FORM.proofs.margins(c, *p)) >= 0


def test_grazing_light_is_exact_whatever_the_coefficients():
    alpha = np.geomspace(0.01, 1, 20)
    at = np.stack([np.zeros(20), alpha], axis=1)
    c = np.random.default_rng(1).exponential(3.0, FORM.size)
    np.testing.assert_allclose(form_values(FORM.fitted(c), at), 1.0, atol=1e-15)


def test_without_masking_of_lights_the_form_is_an_upper_bound_of_e():
    """R = 0 leaves the fraction of visible normals that reflect upwards, in closed form."""
    at = scattered(300)
    bound = form_values(FORM.fitted(np.array([0, 0, 0, 1, 1, 1.0])), at)
    exact = E.values(at)
    assert np.all(exact <= bound + 1e-12)
    # Where light and view are far from grazing on a smooth surface, it is nearly attained.
    assert np.min((bound - exact)[at[:, 0] > 30 * at[:, 1]]) < 1e-4


def test_the_forms_are_quotients_of_linear_functions():
    """So the exchange finds the least largest error that the monomials allow."""
    for form in candidates():
        assert linear_parts(form, scattered(4)) is not None
        assert form.axes == AXES


@pytest.mark.parametrize("at", [(0.0, 0.01), (0.0, 1.0), (1.0, 0.01), (1.0, 1.0), (0.01, 0.01)])
def test_derivatives_are_finite(at):
    c = np.ones(FORM.size)
    assert np.isfinite(jax.grad(lambda p: FORM(c, p[0], p[1]))(np.array(at))).all()
