"""Operators of detail maps and their inverses."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shading import detail

NAMES = ("overlay", "smooth_overlay", "symmetric_overlay")
# Rounding of a few operations with numbers up to 1
RESIDUAL = 1e-14


def blend_and_inverse(name):
    return jax.jit(getattr(detail, name)), jax.jit(getattr(detail, f"{name}_source"))


def hostile_pairs():
    """Return details and targets, with all pairs of numbers near 0, ½, ⅛ (where a = 3) and 1."""
    tiny = 10.0 ** np.arange(-17, -1)
    edge = np.concatenate([[0, 5e-324], tiny, 0.125 + tiny, 0.125 - tiny, 0.5 - tiny, 1 - tiny])
    edge = np.concatenate([edge, [0.125, 0.25, 0.5, 0.75, 1]])
    random = np.random.default_rng(3).uniform(size=(20000, 2))
    return np.concatenate([random, np.stack(np.meshgrid(edge, edge), -1).reshape(-1, 2)]).T


def solves_for_all(blend, inverse) -> bool:
    """Return whether a solution in [0, 1] exists for all details and targets: the condition."""
    d, t = hostile_pairs()
    s = np.asarray(inverse(t, d))
    valid = np.all((s >= 0) & (s <= 1))
    return bool(valid and np.all(np.abs(np.asarray(blend(s, d)) - t) <= RESIDUAL))


def printed(name, s, d):
    """Return the operator as the talk prints it, in NumPy."""
    lower, upper = 2 * s * d, 1 - 2 * (1 - s) * (1 - d)
    share = (2 * s - 1) ** 2
    value = np.where(s < 0.5, lower, upper)
    if name != "overlay":
        value = np.where((s >= 0.5) & (d < 0.5), lower + share * (s - lower), value)
    if name == "symmetric_overlay":
        value = np.where((s < 0.5) & (d >= 0.5), upper + share * (s - upper), value)
    return value


@pytest.mark.parametrize("name", NAMES)
def test_the_formula_is_the_printed_one(name):
    s, d = hostile_pairs()
    blend, _ = blend_and_inverse(name)
    np.testing.assert_allclose(blend(s, d), printed(name, s, d), atol=1e-15)


@pytest.mark.parametrize("name", NAMES)
def test_a_source_exists_for_all_details_and_targets(name):
    assert solves_for_all(*blend_and_inverse(name))


def test_a_blend_without_solutions_is_refused():
    def odds(s, d):
        above = s * d
        below = above + (1 - s) * (1 - d)
        return np.where(below > 0, above / np.where(below > 0, below, 1), 0)

    def odds_source(t, d):
        above = t * (1 - d)
        below = above + (1 - t) * d
        return np.where(below > 0, above / np.where(below > 0, below, 1), 0)

    # The inverse is right where there is one.
    t, d = np.random.default_rng(0).uniform(0.1, 0.9, (2, 1000))
    np.testing.assert_allclose(odds(odds_source(t, d), d), t, atol=1e-14)
    assert not solves_for_all(odds, odds_source)


@pytest.mark.parametrize("name", NAMES)
def test_sources_increase_with_targets_and_end_at_the_ends(name):
    blend, inverse = blend_and_inverse(name)
    t = np.linspace(0, 1, 401)
    for d in (1e-6, 0.1, 0.125, 0.3, 0.5, 0.8, 1 - 1e-6):
        s = np.asarray(inverse(t, d))
        assert np.all(np.diff(s) > 0)
        np.testing.assert_allclose(s[[0, -1]], [0, 1], atol=1e-15)
        np.testing.assert_allclose(inverse(d, d), 0.5, atol=1e-9)
        np.testing.assert_allclose(blend(0.5, d), d, atol=1e-16)


@pytest.mark.parametrize("name", NAMES)
def test_gradients_are_finite_and_equal_differences(name):
    _, inverse = blend_and_inverse(name)
    by_target, by_detail = jax.vmap(jax.grad(inverse, (0, 1)))(*hostile_pairs()[::-1])
    assert np.all(np.isfinite(by_target)) and np.all(np.isfinite(by_detail))
    step = 1e-6
    for t, d in ((0.2, 0.4), (0.7, 0.2), (0.9, 0.125), (0.3, 0.8), (0.95, 0.7)):
        found = jax.grad(inverse, (0, 1))(t, d)
        differences = (
            (inverse(t + step, d) - inverse(t - step, d)) / (2 * step),
            (inverse(t, d + step) - inverse(t, d - step)) / (2 * step),
        )
        np.testing.assert_allclose(found, differences, rtol=1e-6)


def test_slopes_are_those_that_the_pages_state():
    def slope_of(name):
        blend = getattr(detail, name)
        return jax.jit(lambda s, d: jax.jvp(lambda x: blend(x, d), (s,), (jnp.ones_like(s),))[1])

    slopes = {name: slope_of(name) for name in NAMES}
    grid = np.linspace(0, 1, 101)
    d = np.array([0.1, 0.3, 0.7, 0.9])
    below, above = np.full(4, 0.5 - 1e-9), np.full(4, 0.5 + 1e-9)
    overlay, smooth, symmetric = (slopes[name](above, d) - slopes[name](below, d) for name in NAMES)
    np.testing.assert_allclose(overlay, 2 - 4 * d, atol=1e-7)
    np.testing.assert_allclose(smooth, np.where(d < 0.5, 0, 2 - 4 * d), atol=1e-7)
    np.testing.assert_allclose(symmetric, 0, atol=1e-7)
    dark, ones = np.full(4, 0.1), np.ones(4)
    np.testing.assert_allclose(slopes["smooth_overlay"](ones, dark), 5 - 8 * 0.1, atol=1e-12)
    np.testing.assert_allclose(slopes["overlay"](ones, dark), 2 - 2 * 0.1, atol=1e-12)
    pairs = np.stack(np.meshgrid(grid, grid), -1).reshape(-1, 2).T
    for name, largest in zip(NAMES, (2, 5, 5), strict=True):
        found = np.asarray(slopes[name](*pairs))
        assert found.min() >= 0
        np.testing.assert_allclose(found.max(), largest, atol=1e-12)


def test_the_symmetric_kind_is_symmetric():
    s, d = hostile_pairs()
    blend, _ = blend_and_inverse("symmetric_overlay")
    dark = d != 0.5
    mirrored = 1 - np.asarray(blend(1 - s, 1 - d))
    np.testing.assert_allclose(np.asarray(blend(s, d))[dark], mirrored[dark], atol=1e-9)
