"""R by the rule about the fibre: against the product rule, which shares P_s only, and itself."""

import functools
import itertools

import jax.numpy as jnp
import numpy as np
import pytest

from integrals import R
from integrals.compilation import jit_for_few_calls
from integrals.fuzz import lights_about_fibre as module
from integrals.fuzz.lights_about_fibre import estimates_about_fibre
from integrals.many_points import estimates_at_many

# The faces of the domain, and points close to them.
TILTS = (0.0, 1e-9, 0.05, 0.8, 1.5, np.pi / 2 - 1e-9, np.pi / 2)
# What the product rule with 96² nodes misses beyond its stated error; nothing was found.
ROUNDING = 1e-14


def held_to_the_product_rule(points: np.ndarray) -> float:
    """Return the largest stated error, after the values are held to those of the product rule."""
    found = jit_for_few_calls(estimates_about_fibre)(jnp.asarray(points))
    other = R.estimates(points, for_proof=True)
    allowed = np.asarray(found.error) + np.asarray(other.error) + ROUNDING
    assert (np.abs(np.asarray(found.value) - np.asarray(other.value)) <= allowed).all()
    return float(np.max(found.error))


def test_the_rule_agrees_with_the_product_rule():
    points = np.array([*itertools.product((1.0, 0.3, 0.15, 0.06), TILTS)])
    # For these α the product rule is the sharper judge: its errors are below 2e-8.
    assert held_to_the_product_rule(points) < 1e-9
    assert np.asarray(R.estimates(points, for_proof=True).error).max() < 2e-8


def test_without_a_fibre_r_is_a_half():
    points = np.array([[1.0, tilt] for tilt in TILTS])
    np.testing.assert_allclose(estimates_at_many(R, points).value, 0.5, rtol=0, atol=1e-13)


def test_outside_the_domain_there_is_no_value():
    points = np.array([[0.0, 0.3], [-0.1, 0.3], [1.1, 0.3], [0.5, -0.1], [0.5, 1.6], [0.5, np.nan]])
    found = estimates_at_many(R, np.concatenate([points, [[0.5, 0.3]]]))
    assert np.isnan(found.value[:-1]).all() and np.isnan(found.error[:-1]).all()
    assert found.error[-1] < 1e-9


@pytest.mark.slow
def test_the_rule_agrees_with_more_nodes_on_the_whole_domain(monkeypatch):
    """At 10,240 points, of which a tenth are on the faces; α is also almost zero."""
    rng = np.random.default_rng(5)
    alpha = np.concatenate([np.geomspace(1e-3, 1, 5120), rng.uniform(0.001, 1, 4096)])
    alpha = np.concatenate([alpha, 10.0 ** rng.uniform(-50, -3, 1024)])
    theta_f = rng.uniform(0, np.pi / 2, len(alpha))
    theta_f[::10] = rng.choice([*TILTS], len(theta_f[::10]))
    points = np.stack([alpha, theta_f], axis=1)
    found = jit_for_few_calls(estimates_about_fibre)(jnp.asarray(points))
    monkeypatch.setattr(module, "_RINGS", 40)
    monkeypatch.setattr(module, "_LIGHTS", 28)
    module._ring_rule.cache_clear()
    module._light_rule.cache_clear()
    # Another object, for which nothing is compiled yet
    finer = jit_for_few_calls(functools.partial(estimates_about_fibre))(jnp.asarray(points))
    module._ring_rule.cache_clear()
    module._light_rule.cache_clear()
    wrong = np.abs(np.asarray(found.value) - np.asarray(finer.value))
    usual = alpha >= 1e-3
    assert (wrong <= np.asarray(found.error)).all()
    assert wrong[usual].max() < 1e-11
    assert np.asarray(found.error)[usual].max() < 3e-8
    # The nodes do not become denser below α = 1e-4.
    assert wrong.max() < 1e-6


@pytest.mark.slow
def test_the_rule_agrees_with_the_product_rule_on_the_whole_domain():
    rng = np.random.default_rng(6)
    points = np.stack([rng.uniform(1e-3, 1, 1024), rng.uniform(0, np.pi / 2, 1024)], axis=1)
    assert held_to_the_product_rule(points) < 3e-8
