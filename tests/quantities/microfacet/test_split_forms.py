"""Forms of A and B: they add up to E, and lie between 0 and E."""

import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import form_values
from integrals import GGX_BIAS, GGX_SCALE
from quantities.microfacet.split_forms import (
    ALBEDO,
    ALBEDO_COEFFICIENTS,
    candidates,
    masked_bias,
    masked_scale,
)

CHOSEN = {"numerator": ((0, 0), (0, 2), (1, 2)), "denominator": ((0, 0), (0, 1), (1, 1))}


def scattered(count: int) -> np.ndarray:
    rng = np.random.default_rng(6)
    alpha = 10 ** (-2 * rng.random(count))
    return np.stack([np.minimum(alpha * 10 ** rng.uniform(-3, 3, count), 1.0), alpha], axis=1)


def test_a_and_b_with_the_same_coefficients_add_up_to_the_best_e():
    table = resolve("best/ggx-directional-albedo-57")
    form = table.require_fitted().form
    assert (form.shape["numerator"], form.shape["denominator"]) == tuple(
        [list(each) for each in part] for part in ALBEDO
    )
    assert table.require_fitted().constants.tolist() == list(ALBEDO_COEFFICIENTS)
    at, c = scattered(500), np.array([0.9, 0.3, 0.2, 0.8, 1.5])
    a, b = (form_values(make(**CHOSEN).fitted(c), at) for make in (masked_scale, masked_bias))
    np.testing.assert_allclose(a + b, form_values(table.require_fitted(), at), atol=1e-14)
    assert min(a.min(), b.min()) >= 0


def test_b_is_e_times_a_fifth_power():
    at, c = scattered(50), np.array([0.9, 0.3, 0.2, 0.8, 1.5])
    mu, alpha = at.T
    sigma = np.sqrt(alpha**2 + (1 - alpha**2) * mu**2)
    t = (0.9 + 0.3 * sigma**2 + 0.2 * mu * sigma**2) / (1 + 0.8 * sigma + 1.5 * mu * sigma)
    e = form_values(resolve("best/ggx-directional-albedo-57").require_fitted(), at)
    np.testing.assert_allclose(
        form_values(masked_bias(**CHOSEN).fitted(c), at), e * t**5, rtol=1e-12
    )


@pytest.mark.parametrize(
    ("make", "reference"), [(masked_bias, GGX_BIAS), (masked_scale, GGX_SCALE)]
)
def test_the_start_is_near_the_quantity(make, reference):
    """A fit from a start that has poles, or is far away, would find another minimum."""
    at = scattered(200)
    exact = reference.values(at)
    for form in candidates(make):
        values = form_values(form.fitted(form.starts[0]), at)
        assert np.abs(values - exact).max() < 0.5
        assert np.sqrt(np.mean((values - exact) ** 2)) < 0.15
