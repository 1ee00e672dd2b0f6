"""Throughput: the two sides compute the same, and failures are errors of one line."""

import os
import re
import shutil
import subprocess

import numpy as np
import pytest

from programs import write_source
from programs.toolchains import throughput as timing
from programs.toolchains.throughput import measure_throughput
from tests.programs.toys import ARRAYS, SCALAR, UNIT

# gcc and XLA compile the same float32 expression: they contract differently and have another exp.
DIFFERENCE = 1e-6

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not on PATH")


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
def test_given_inputs_are_measured():
    rows = np.random.default_rng(1).uniform(0.25, 1, (3000, 3))
    measured = measure_throughput(ARRAYS, rounds=2, rows=rows)
    assert measured.points == 3000
    assert measured.difference <= DIFFERENCE


@needs_gcc
def test_code_with_another_constant_shows_in_the_difference(monkeypatch):
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


def test_a_missing_compiler_is_an_error(monkeypatch):
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
def test_no_points_or_no_rounds_are_refused(bad):
    with pytest.raises(ValueError, match="allowed: at least 1 each"):
        measure_throughput(SCALAR, **bad)


def test_random_inputs_fill_the_domain():
    inputs = timing._random_inputs(ARRAYS, 1000)
    assert inputs.shape == (3, 1000) and inputs.dtype == np.float32
    assert inputs.min() >= UNIT[0] and inputs.max() <= UNIT[1]
    assert inputs.min() < 0.26 and inputs.max() > 0.99


@pytest.mark.parametrize(("key", "compiler"), [("c", "gcc"), ("cpp", "g++")])
def test_loops_over_an_exported_function_are_vectorised_in_a_library_too(tmp_path, key, compiler):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not on PATH")
    loop = (
        "void all(int n, const float *__restrict a, const float *__restrict d, float *__restrict o)"
        "{ for (int i = 0; i < n; ++i) o[i] = Rational(a[i], d[i]); }\n"
    )

    def vectorised(source):
        path = tmp_path / f"loop.{key}"
        path.write_text(source + loop)
        command = [compiler, *timing.FLAGS, "-fPIC", "-fopt-info-vec", "-c", path, "-o", "loop.o"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        return "loop vectorized" in done.stderr

    source = write_source(SCALAR, key)
    assert vectorised(source)
    # A library must not inline an external function, because another library may replace it.
    assert not vectorised(re.sub(r"^(static )?inline ", "", source, flags=re.MULTILINE))
