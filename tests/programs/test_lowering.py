"""Operations that a language lacks: what stands for them, and how accurate that is."""

import jax.numpy as jnp
import numpy as np
import pytest

from programs import LANGUAGES, Parameter, evaluate, function, trace, write_source
from programs.printing.lowering import lowered

HLSL = LANGUAGES["hlsl"].functions["float"]
NEAR = np.geomspace(1e-30, 0.5, 2001)


def traced(call, domain):
    return trace(function("f", (Parameter("x", domain),), call))


@pytest.mark.parametrize(
    ("call", "exact", "domain"),
    [(jnp.expm1, np.expm1, (-20.0, 20.0)), (jnp.log1p, np.log1p, (-0.99, 20.0))],
)
def test_a_missing_function_is_accurate_to_float32_everywhere(call, exact, domain):
    program = lowered(traced(call, domain), HLSL)
    assert {"expm1", "log1p"}.isdisjoint(step.operation for step in program.steps)
    x = np.concatenate([np.linspace(*domain, 100_001), NEAR, -NEAR])
    x = x.astype(np.float32).astype(float)
    x = x[x != 0]
    relative = np.abs(evaluate(program, x[:, None])[:, 0] / exact(x) - 1)
    assert np.max(relative) < 3e-8
    # In float32, 1 + x of log1p and e^x − 1 are rounded before they are used.
    single = evaluate(program, x[:, None], np.float32)[:, 0].astype(float)
    scale = np.maximum(np.abs(exact(x)), np.abs(x) * 1e-3)
    assert np.max(np.abs(single - exact(x)) / scale) < 6e-7


def test_zero_stays_zero():
    for call in (jnp.expm1, jnp.log1p):
        assert evaluate(lowered(traced(call, (-0.5, 0.5)), HLSL), np.zeros((1, 1)))[0, 0] == 0


def test_a_program_that_lacks_nothing_is_the_same():
    program = traced(lambda x: jnp.expm1(x) * jnp.log1p(x), (0.0, 1.0))
    assert lowered(program, LANGUAGES["c"].functions["float"]) is program


def test_code_of_a_language_without_the_function_is_printed_with_names_kept():
    def call(x):
        grown = jnp.expm1(x) + 1
        return grown * grown * jnp.log1p(grown)

    source = write_source(function("f", (Parameter("x", (0.0, 1.0)),), call), "glsl")
    assert "expm1" not in source
    assert "grown" in source
    assert "exp(" in source
    assert "log(" in source
