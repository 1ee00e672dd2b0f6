"""Exported curvature and packing: verified where they are run, and finite for hostile inputs."""

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.exported_code import trial_of
from programs import check, evaluate, toolchain, trace
from quantities.curvature import CURVATURES

NAMES = [f"curvature/{name}" for name in CURVATURES]
# The C code of the quotient has no operation that the others lack.
COMPILED = [
    pytest.param(name, marks=pytest.mark.slow) if name == "curvature/along-light" else name
    for name in NAMES
]


@pytest.mark.parametrize("name", COMPILED)
def test_code_in_c_passes(name):
    if toolchain("c").missing("float"):
        pytest.skip("gcc is missing")
    result = check(trial_of(resolve(name), "float", 8), "c")
    assert result.status == "passed", result.reason
    assert result.form.not_finite == 0


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("dtype", [np.float32, np.float16])
def test_values_are_finite_for_hostile_numbers(name, dtype):
    (function,) = resolve(name).functions()
    program = trace(function)
    extremes = np.array([0.0, -0.0, 1e-7, -1.0, 1.0, 0.7, 60.0, -60.0, 1e-40])
    inputs = np.random.default_rng(2).choice(
        extremes, (4000, sum(each.size or 1 for each in function.parameters))
    )
    found = evaluate(program, inputs, dtype)
    assert np.isfinite(found).all()
