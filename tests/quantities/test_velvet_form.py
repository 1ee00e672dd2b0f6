"""The fit of r(k), which never creates energy, and its shader code."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import FittedForm
from fitting.points.grids import trapezoid_grid
from fitting.proofs.pole_proof import certify_denominators
from integrals import VELVET
from integrals.fuzz.velvet import normalisation
from programs import Function, Parameter, evaluate, trace
from quantities.fuzz.velvet_form import (
    CONSERVATIVE_NORM,
    MARGIN,
    certify_conservative,
    fit_conservative_norm,
)

EPS = np.finfo(float).eps
DOMAIN_END = 0.95

VALUE = jax.jit(jax.vmap(VELVET.value))


@functools.cache
def fitted(count) -> FittedForm:
    grid = trapezoid_grid(CONSERVATIVE_NORM.axes, count)
    exact = VALUE(jnp.asarray(grid.points[:, 0]))
    return CONSERVATIVE_NORM.fitted(fit_conservative_norm(grid, exact))


@pytest.mark.parametrize("count", [9, pytest.param(65, marks=pytest.mark.slow)])
def test_fit_loses_little_energy_and_creates_none(count):
    form = fitted(count)
    assert certify_conservative(form).holds
    assert certify_denominators(form).bound > 0.99
    k = -DOMAIN_END * np.random.default_rng(3).random(100_000)
    exact = np.asarray(VALUE(k))
    loss = 1 - np.asarray(jax.jit(jax.vmap(form))(k)) / exact
    assert np.all(loss >= -4 * EPS)
    assert loss.max() < 1.2e-3
    assert form(0.0) == 1


def test_table_and_float32_code_create_no_energy():
    entry = resolve("velvet")
    stated = entry.require_table().certificates.conservative_bound
    assert certify_conservative(entry.require_fitted()).bound == stated > 0
    (exported,) = entry.functions()
    k = (-DOMAIN_END * np.random.default_rng(4).random(100_000)).astype(np.float32)
    values = np.ravel(evaluate(trace(exported), k[:, None], np.float32))
    # Rounding may exceed the limit by less than the last bit of one.
    assert np.max(values / np.asarray(VALUE(k.astype(float)))) <= 1 + 2 * np.finfo(np.float32).eps


def test_fit_that_creates_energy_is_not_certified():
    form = fitted(9)
    bound = certify_conservative(form).bound
    assert 0 < bound <= MARGIN
    for coefficient, below in ((0, 2 * MARGIN), (1, 1e-4), (2, 1e-3)):
        lower = form.coefficients.at[coefficient].add(-below)
        assert not certify_conservative(CONSERVATIVE_NORM.fitted(lower)).holds


def test_exact_factor_can_be_exported_as_shader_code():
    parameters = (Parameter("k", (-DOMAIN_END, 0.0)),)
    program = trace(Function("Exact", "r.", parameters, None, "value", normalisation))
    k = np.append(-DOMAIN_END * np.random.default_rng(5).random(1000), [0.0, -0.25])
    np.testing.assert_allclose(np.ravel(evaluate(program, k[:, None])), VALUE(k), rtol=64 * EPS)


def test_form_is_differentiable_on_its_closed_domain():
    k = np.array([0.0, -1e-9, -0.4, -DOMAIN_END])
    assert np.isfinite(jax.vmap(jax.grad(fitted(9)))(k)).all()
