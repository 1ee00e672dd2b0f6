import os
import shutil

import jax.numpy as jnp
import numpy as np
import pytest

from programs.cost import WEIGHTS, Cost, count_operations
from programs.functions import Function, Parameter
from programs.toolchains import throughput as timing
from programs.toolchains.throughput import measure_throughput
from programs.tracing.tracer import trace

# Two compilers of the same float32 expression: contraction into fma, another exp.
DIFFERENCE = 1e-6

UNIT = (0.25, 1.0)
SCALAR = Function(
    "Rational",
    "A rational function.",
    (Parameter("alpha", UNIT), Parameter("d", UNIT)),
    None,
    "result",
    lambda alpha, d: (0.5 + alpha * (0.25 + alpha * d)) / jnp.sqrt(1.0 + d * d),
)
ARRAYS = Function(
    "Scaled",
    "An array in, an array out.",
    (Parameter("c", UNIT, size=2), Parameter("x", UNIT)),
    2,
    "results",
    lambda c, x: (c[0] + c[1] * x, jnp.exp(-c[1]) * x),
)

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not on PATH")


def of_x(call):
    return trace(Function("Example", "E.", (Parameter("x", UNIT),), None, "result", call))


COUNTS = {
    "Horner": (lambda x: 0.5 + x * (0.25 + x * (2.0 + x)), Cost(add=3, mul=2, fma=2)),
    "shared product": (lambda x: (x * x + 1.0) * (x * x - 2.0), Cost(add=2, mul=2)),
    "quotient": (lambda x: x / (1.0 + x), Cost(add=1, div=1)),
    "two products": (lambda x: x * x + 3.0 * x, Cost(add=1, mul=2, fma=1)),
    "root": (lambda x: jnp.sqrt(-x), Cost(sqrt=1, sign=1)),
    "clamp": (lambda x: jnp.clip(x, 0.1, 0.5), Cost(select=2)),
    "choice": (lambda x: jnp.where(x > 0.0, x, 1.0), Cost(select=2)),
    "functions": (lambda x: jnp.sin(x) * jnp.power(x, 0.3), Cost(mul=1, transcendental=2)),
    "nothing": (lambda x: x, Cost()),
    "constant": (lambda x: jnp.asarray(0.5) * 2.0, Cost()),
}


@pytest.mark.parametrize("name", COUNTS)
def test_operations_are_counted_by_kind(name):
    call, expected = COUNTS[name]
    assert count_operations(of_x(call)) == expected


def test_totals_weigh_each_kind():
    each = Cost(add=1, mul=1, div=1, sqrt=1, transcendental=1, select=1, sign=1, fma=1)
    assert each.operations == 6
    assert each.weighted == sum(WEIGHTS.values())
    assert Cost(div=2, sign=5).weighted == 2 * WEIGHTS["div"]


def test_what_does_not_vary_is_not_counted_twice():
    program = trace(SCALAR)
    assert count_operations(program) == Cost(add=3, mul=3, div=1, sqrt=1, fma=3)
    assert count_operations(program, ["alpha"]) == Cost(add=2, mul=2, div=1, fma=2)
    assert count_operations(program, ["alpha", "d"]) == count_operations(program)
    assert count_operations(program, []) == Cost()
    arrays = trace(ARRAYS)
    assert count_operations(arrays, ["x"]) == Cost(add=1, mul=2, fma=1)
    assert (
        count_operations(arrays, ["c[1]"]).transcendental
        == count_operations(arrays, ["c"]).transcendental
        == 1
    )
    assert count_operations(arrays, ["c[0]"]) == Cost(add=1, fma=1)


def test_an_unknown_input_is_refused():
    with pytest.raises(ValueError, match="'beta' is no input of Rational; allowed: alpha, d"):
        count_operations(trace(SCALAR), ["beta"])


@needs_gcc
@pytest.mark.parametrize("function", [SCALAR, ARRAYS], ids=lambda function: function.name)
def test_both_sides_of_the_measurement_compute_the_same(function):
    measured = measure_throughput(function, points=2000, rounds=2)
    assert measured.difference <= DIFFERENCE
    assert measured.compiled > 0 and measured.jax > 0
    assert measured.ratio == measured.compiled / measured.jax
    assert "gcc" in measured.compiler
    assert measured.points == 2000


@needs_gcc
def test_a_wrong_compilation_shows(monkeypatch):
    right = timing.write_source
    monkeypatch.setattr(
        timing, "write_source", lambda *given: right(*given).replace("0.5f", "0.75f")
    )
    assert measure_throughput(SCALAR, points=500, rounds=1).difference > 0.1


@needs_gcc
def test_code_that_does_not_compile_is_an_error(monkeypatch):
    monkeypatch.setattr(
        timing, "write_source", lambda *given: "float Rational(float a, float d) { nonsense }"
    )
    with pytest.raises(ValueError, match=r"(?s)Rational .*not compile.*error: .nonsense. undecl"):
        measure_throughput(SCALAR, points=500, rounds=1)


def test_without_a_compiler_there_is_no_figure(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(ValueError, match="gcc is not on PATH"):
        measure_throughput(SCALAR, points=500, rounds=1)


@pytest.mark.parametrize(
    ("script", "complaint"),
    [
        ("#!/bin/sh\nexit 1\n", r"does not compile \(status 1\)"),
        ("#!/bin/sh\nexit 0\n", "is no library"),
    ],
)
def test_a_compiler_that_fails_is_an_error_in_one_line(monkeypatch, tmp_path, script, complaint):
    compiler = tmp_path / "gcc"
    compiler.write_text(script)
    compiler.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    with pytest.raises(ValueError, match=complaint) as caught:
        measure_throughput(SCALAR, points=500, rounds=1)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("bad", [{"points": 0}, {"rounds": 0}])
def test_nothing_cannot_be_measured(bad):
    with pytest.raises(ValueError, match="allowed: at least 1 each"):
        measure_throughput(SCALAR, **bad)


def test_points_lie_in_the_domain():
    inputs = timing._random_inputs(ARRAYS, 1000)
    assert inputs.shape == (3, 1000) and inputs.dtype == np.float32
    assert inputs.min() >= UNIT[0] and inputs.max() <= UNIT[1]
    assert inputs.min() < 0.26 and inputs.max() > 0.99
