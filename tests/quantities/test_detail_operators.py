"""Exported operators of detail maps: their code computes what `shading` computes."""

import functools

import jax
import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.exported_code import trial_of
from programs import check, evaluate, toolchain, trace
from quantities.detail import OPERATORS
from shading import detail

NAMES = [f"detail/{name}" for name in OPERATORS]
_TYPES = {"double": np.float64, "float": np.float32, "half": np.float16}


@functools.cache
def _traced(name, precision):
    (function,) = resolve(name).functions(precision)
    return trace(function)


def evaluated(name, rows, precision):
    return evaluate(_traced(name, precision), rows, _TYPES[precision])[:, 0]


@pytest.mark.parametrize("name", ["overlay", "smooth-overlay", "symmetric-overlay"])
def test_code_computes_the_model(name):
    rows = np.random.default_rng(1).uniform(size=(2000, 2))
    blend = jax.jit(getattr(detail, name.replace("-", "_")))
    found = evaluated(f"detail/{name}", rows, "double")
    np.testing.assert_allclose(found, blend(*rows.T), atol=1e-15)
    source = evaluated(f"detail/{name}-inverse", rows, "double")
    np.testing.assert_allclose(blend(source, rows[:, 1]), rows[:, 0], atol=1e-14)


@pytest.mark.parametrize("precision", ["float", "half"])
@pytest.mark.parametrize("name", NAMES)
def test_values_are_in_the_unit_interval_for_hostile_numbers(name, precision):
    edges = [-1e4, -1.0, -0.0, 0.0, 6e-8, 1e-5, 1e-3, 0.125, 0.4999, 0.5, 0.5005, 0.9995, 1.0, 7e4]
    edges += [*np.linspace(0, 1, 33), float("inf"), float("-inf")]
    rows = np.stack(np.meshgrid(edges, edges), -1).reshape(-1, 2)
    with np.errstate(over="ignore"):
        found = evaluated(name, rows, precision)
    assert np.all((found >= 0) & (found <= 1))


def test_code_in_c_passes():
    if toolchain("c").missing("float"):
        pytest.skip("gcc is missing")
    trial = trial_of(resolve("detail/smooth-overlay-inverse"), "float", 8)
    result = check(trial, "c")
    assert result.status == "passed", result.reason
    # Where the detail is near 0, a rounding of the target moves the source by its root.
    assert result.allowed.largest < 1e-3
