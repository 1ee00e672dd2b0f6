"""Generic shapes of forms: monomials, poles and surfaces."""

import jax.numpy as jnp
import numpy as np
import pytest

from fitting.shapes.monomials import horner
from fitting.shapes.poles import least_offset, pole_names, pole_starts, poles_value
from fitting.shapes.surfaces import flat_start, surface_names, surface_values

Z, Y = 0.3, -0.7


@pytest.mark.parametrize(
    "exponents",
    [((0, 0),), ((2, 0),), ((0, 3),), ((0, 0), (1, 2), (3, 1), (3, 0)), ((1, 1), (4, 4))],
)
def test_horners_rule_gives_the_sum_of_monomials(exponents):
    c = np.random.default_rng(1).normal(size=len(exponents))
    expected = sum(a * Z**i * Y**j for a, (i, j) in zip(c, exponents, strict=True))
    found = horner(dict(zip(exponents, c, strict=True)), Z, Y)
    assert float(found) == pytest.approx(float(expected), rel=1e-14)


@pytest.mark.parametrize(("terms", "poles"), [(0, 1), (1, 0), (3, 0), (2, 2)])
def test_a_polynomial_and_poles_are_added(terms, poles):
    c = np.random.default_rng(2).uniform(0.1, 1, terms + 2 * poles)
    expected = sum(c[k] * Z**k for k in range(terms))
    expected += sum(c[terms + 2 * k] / (c[terms + 2 * k + 1] + Z) for k in range(poles))
    found = poles_value(c, terms, poles, jnp.asarray(Z))
    assert float(found) == pytest.approx(float(expected), rel=1e-14)
    assert len(pole_names(terms, poles)) == len(c)
    assert {len(start) for start in pole_starts(terms, poles)} == {len(c)}
    assert len(set(pole_names(terms, poles))) == len(c)


def test_poles_are_named_and_started_where_they_are():
    assert pole_names(3, 2) == ["c0: 1", "c1: x", "c2: x²", "a1", "b1", "a2", "b2"]
    for start in pole_starts(1, 3):
        np.testing.assert_array_equal(start[[0, 1, 3, 5]], 0)
        assert (start[[2, 4, 6]] > 0).all()
    assert len(pole_starts(1, 3)) == 3
    assert len(pole_starts(1, 0)) == 1


def test_the_least_offset_is_that_of_the_nearest_pole():
    c = np.array([5.0, 1.0, 0.3, 2.0, -0.1])
    assert float(least_offset(c, 1, 2)) == -0.1
    assert float(least_offset(np.array([5.0, 1.0, 7.0]), 1, 1)) == 1
    assert float(least_offset(np.array([5.0]), 1, 0)) == 1


def test_surfaces_are_polynomials_of_a_total_degree():
    names = surface_names(["u", "v"], 2, "α", "y")
    assert names[:6] == ["u: α^0 y^0", "u: α^0 y^1", "u: α^0 y^2", "u: α^1 y^0", "u: α^1 y^1",
                         "u: α^2 y^0"]  # fmt: skip
    c = np.random.default_rng(3).normal(size=12)
    basis = np.array([1, Y, Y**2, Z, Z * Y, Z**2])
    values = surface_values(c, 2, 2, Z, Y)
    np.testing.assert_allclose(values, [c[:6] @ basis, c[6:] @ basis], rtol=1e-14)
    (constant,) = surface_values(np.array([0.25]), 1, 0, Z, Y)
    assert float(constant) == 0.25


def test_flat_starts_are_constant_surfaces_some_of_which_slope():
    start = flat_start([0.2, -0.5], 2, {1: (1.0, 1.7)})
    values = surface_values(start, 2, 2, Z, Y)
    np.testing.assert_allclose(values, [0.2, -0.5 + 1.0 * Z + 1.7 * Y], rtol=1e-14)
    # A surface of degree 0 has no slopes to set.
    np.testing.assert_array_equal(flat_start([0.2, -0.5], 0, {1: (1.0, 1.7)}), [0.2, -0.5])
