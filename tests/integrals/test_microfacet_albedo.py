"""E, its Fresnel split and E_avg: known values, closed forms, limits, errors and derivatives."""

import functools

import jax
import mpmath as mp
import numpy as np
import pytest

from integrals.microfacet import average_albedo, directional_albedo, fresnel_split
from integrals.microfacet.average_albedo import average_of_directional
from shading.microfacet import uncorrelated_visibility
from tests.batches import batched
from tests.integrals.differences import difference

# α, μ, E, B, E of the uncorrelated masking: computed apart from this package. E has 15 digits.
# B was truncated at 1e-12.
KNOWN = np.array(
    [
        (0.01, 0.01, 0.891987352354539, 0.7676235597377, 0.8815273213615),
        (0.01, 0.5, 0.999742122599131, 0.0314032726715, 0.9997421165746),
        (0.05, 0.05, 0.889894054270654, 0.4897863213217, 0.8793708603063),
        (0.1, 0.1, 0.883455001867146, 0.3009115087809, 0.8727560836344),
        (0.1, 0.9, 0.986743608725872, 0.0001234345407, 0.9867423603485),
        (0.25, 0.3, 0.837905764575236, 0.0653702498984, 0.8297579116256),
        (0.5, 0.5, 0.698250696927548, 0.0101499847798, 0.6860072499737),
        (0.75, 0.05, 0.880609563664647, 0.0455978552822, 0.6879996343687),
        (1.0, 0.2, 0.641648106154389, 0.0140276012806, 0.5114213657334),
    ]
).T
KNOWN_AVERAGES = np.array(
    [
        (0.05, 0.991283633533437515),
        (0.1, 0.972045756815704795),
        (0.25, 0.882323382618251381),
        (0.5, 0.700240469124784926),
        (0.75, 0.536302859034373096),
        (0.9, 0.455568076568834825),
        (1.0, 4 / 3 * (1 - np.log(2))),
    ]
).T


@functools.cache
def albedo(**options):
    return batched(functools.partial(directional_albedo, **options), 16)


@functools.cache
def split(**options):
    return batched(functools.partial(fresnel_split, **options), 16)


@functools.cache
def average(**options):
    return batched(functools.partial(average_albedo, **options), 16)


def points(seed, count, least_alpha=0.01, least_mu=1e-4):
    """Return μ and α, half of them with μ of the order of α, and some at normal incidence."""
    rng = np.random.default_rng(seed)
    alpha = np.exp(rng.uniform(np.log(least_alpha), 0, count))
    near = np.clip(alpha * np.exp(rng.uniform(-4, 4, count)), least_mu, 1)
    spread = np.exp(rng.uniform(np.log(least_mu), 0, count))
    kind = rng.integers(0, 5, count)
    mu = np.select([kind < 2, kind == 2, kind == 3], [near, spread, rng.random(count)], 1.0)
    return np.maximum(mu, least_mu), alpha


def normal_albedo(alpha) -> float:
    """Return E(1, α) by its closed form, with guard digits for its division by α⁴."""
    with mp.workdps(40):
        a = mp.mpf(float(alpha))
        p, k = a * a, mp.sqrt(1 - a * a)
        q = k * mp.sqrt(1 + 3 * p)
        inner = 2 * a * p * (a * k * k + q) / ((1 + p) * (k * k * (1 + 2 * p) + q))
        total = 2 * a * p - (1 + p * p) * mp.log((1 + a) / a) - mp.log(p)
        total += (1 - p * p) * mp.log((1 + p) / p)
        total += k * (1 + 2 * p - p * p) / mp.sqrt(1 + 3 * p) * mp.log(inner)
        return float(total / (2 * p * p))


def test_known_values():
    alpha, mu, exact, offset, uncorrelated = KNOWN
    np.testing.assert_allclose(albedo()(mu, alpha).value, exact, rtol=0, atol=2e-15)
    other = albedo(visibility=uncorrelated_visibility)(mu, alpha).value
    np.testing.assert_allclose(other, uncorrelated, rtol=0, atol=1e-13)
    np.testing.assert_allclose(split()(mu, alpha).offset.value, offset, rtol=0, atol=2e-12)


def test_fresnel_offset_equals_nested_quadrature_of_twenty_digits():
    """The value is that of mpmath's quad over azimuth and ν, which took half a minute."""
    value = fresnel_split(0.1, 0.1).offset.value
    assert abs(value - 0.30091150878154963415) < 1e-14


def test_known_averages():
    alpha, exact = KNOWN_AVERAGES
    np.testing.assert_allclose(average()(alpha).value, exact, rtol=0, atol=4e-15)


def test_average_is_the_cosine_average_of_the_directional_albedo():
    alpha = np.array([0.01, 0.1, 0.4, 1.0])
    value, error = average()(alpha)
    other, allowance = batched(average_of_directional, 4)(alpha)
    assert np.all(abs(value - other) <= error + allowance)
    np.testing.assert_allclose(value, other, rtol=0, atol=1e-13)


def test_fully_rough_surface_and_normal_view_have_closed_forms():
    mu = np.array([1e-4, 1e-2, 0.3, 0.8, 1.0])
    value, error = albedo()(mu, np.ones(5))
    assert np.all(abs(value - (1 - mu * np.log1p(1 / mu))) <= error)
    alpha = np.array([0.01, 0.02, 0.1, 0.3, 0.6, 0.999])
    value, error = albedo()(np.ones(6), alpha)
    exact = [normal_albedo(a) for a in alpha]
    assert np.all(abs(value - exact) <= error)
    np.testing.assert_allclose(value, exact, rtol=0, atol=1e-13)


def test_grazing_albedo_is_one():
    alpha = np.array([0.01, 0.1, 0.5, 1.0])
    value, error = albedo()(np.zeros(4), alpha)
    assert np.all(abs(value - 1) <= error)
    np.testing.assert_allclose(value, 1, rtol=0, atol=1e-11)


def test_offset_of_a_fully_rough_surface_at_grazing_view():
    """B(0, 1) = 1/21."""
    assert abs(fresnel_split(0.0, 1.0).offset.value - 1 / 21) < 1e-13


def test_values_are_within_their_stated_errors():
    sample = np.concatenate([points(0, 48), points(1, 16, 1e-3, 1e-30)], axis=1)
    for method, fine in ((albedo, {"nodes": 160}), (split, {"nodes": 128, "azimuths": 256})):
        found, truth = method()(*sample), method(**fine)(*sample)
        if method is split:
            found, truth = found.offset, truth.offset
        gap = abs(found.value - truth.value)
        assert np.all(gap <= found.error + truth.error)
    value, error = albedo()(*points(2, 64))
    assert np.all(error < 1e-12)
    assert np.all((value > 0) & (value <= 1))


def test_averages_are_within_their_stated_errors():
    alpha = np.exp(np.random.default_rng(3).uniform(np.log(1e-3), 0, 15))
    value, error = average()(np.append(alpha, 1.0))
    truth, finer = average(nodes=128)(np.append(alpha, 1.0))
    assert np.all(abs(value - truth) <= error + finer)
    assert np.all(error[:-1][alpha > 0.01] < 1e-12)


def test_derivatives_are_finite_and_equal_finite_differences():
    ends = np.array([(m, a) for a in (0.01, 0.3, 1.0) for m in (0.0, 1e-9, 1 - 1e-9, 1.0)]).T
    inside = np.stack(points(4, 20, 0.05, 0.05))
    for method in (
        lambda m, a: directional_albedo(m, a).value,
        lambda m, a: fresnel_split(m, a, azimuths=96).offset.value,
    ):
        slopes = batched(jax.grad(method, (0, 1)), 16)
        assert np.isfinite(slopes(*ends)).all()
        value = batched(method, 16)
        found = slopes(*inside)
        step = 2e-3 * np.minimum(*inside)
        for axis in (0, 1):
            expected = difference(lambda x, at=value: at(*x), inside, axis, step, 0.0, 1.0)
            np.testing.assert_allclose(found[axis], expected, rtol=1e-6, atol=1e-7)


def test_slope_of_the_average_equals_finite_differences_up_to_both_ends():
    alpha = np.array([0.01, 0.1, 0.5, 0.9, 1 - 1e-9, 1.0])
    found = batched(jax.grad(lambda a: average_albedo(a).value), 8)(alpha)
    expected = difference(lambda x: average()(x[0]).value, alpha[None], 0, 2e-3 * alpha, 0, 1.0)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("alpha", [0.01, 0.3, 1.0])
def test_a_schlick_surface_reflects_between_nothing_and_the_whole_albedo(alpha):
    mu = np.linspace(0, 1, 16)
    scale, offset = split()(mu, np.full(16, alpha))
    assert np.all(scale.value >= -scale.error)
    assert np.all(offset.value >= 0)
    exact, error = albedo()(mu, np.full(16, alpha))
    assert np.all(abs(scale.value + offset.value - exact) <= scale.error + error)
