"""Random scalar expressions are traced, printed in Python and C, run, and compared with JAX."""

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jax.ad_checkpoint import checkpoint_name

from programs.functions import Function, Parameter, group_inputs
from programs.languages import LANGUAGES, PRECISIONS
from programs.printing.printer import write_source
from programs.program import evaluate
from programs.tracing.tracer import trace

# Every node below is at most 2 and amplifies a change of its operands at most twice. A dozen nodes
# amplify a difference of one unit in the last place to less than this.
TOLERANCE = {"float": 1e-3, "double": 1e-12}

WEIGHTS = np.array([0.25, -0.5, 0.125])

UNARY = {
    "sin": jnp.sin,
    "cos": jnp.cos,
    "tanh": jnp.tanh,
    "root": lambda a: jnp.sqrt(jnp.abs(a) + 0.25),
    "log": lambda a: jnp.log(1.0 + a * a),
    "bell": lambda a: jnp.exp(-(a**2)),
    "rational": lambda a: 1.0 / (1.0 + a * a),
    "cube": lambda a: (0.5 * a) ** 3,
    "minus": lambda a: -a,
    "shifted": lambda a: 0.5 * (a - (-0.75)),
    "logistic": jax.nn.sigmoid,
    "clipped": lambda a: jnp.clip(a, -0.3, 0.7),
    "atan": jnp.arctan,
}
BINARY = {
    "mean": lambda a, b: 0.5 * (a + b),
    "half difference": lambda a, b: 0.5 * (a - b),
    "product": lambda a, b: 0.5 * a * b,
    "larger": jnp.maximum,
    "smaller": jnp.minimum,
    "ratio": lambda a, b: a / (2.0 + jnp.abs(b)),
    "nested difference": lambda a, b: 0.25 * (a - (b - (a - 0.125))),
    "dot": lambda a, b: WEIGHTS @ jnp.stack([a, b, 0.5 * a]),
    "both": lambda a, b: jnp.sum(jnp.asarray([a, b]) * np.array([0.5, 0.25])),
}

LEAVES = st.one_of(
    st.sampled_from(["x", "y", "z[0]", "z[1]"]),
    st.floats(-1, 1, allow_nan=False, width=32).map(float),
)


def _extended(children):
    return st.one_of(
        st.tuples(st.sampled_from(sorted(UNARY)), children),
        st.tuples(st.sampled_from(sorted(BINARY)), children, children),
        # The condition compares inputs with constants, so that rounding cannot change it.
        st.tuples(st.just("where"), st.floats(-1, 1, width=16), children, children),
    )


TREES = st.recursive(LEAVES, _extended, max_leaves=12)


def compute(tree, inputs):
    """Evaluate a tree with JAX; `inputs` maps the names of the leaves to scalars."""
    if isinstance(tree, str):
        return inputs[tree]
    if isinstance(tree, float):
        return jnp.asarray(tree)
    kind, *rest = tree
    if kind == "where":
        bound, yes, no = rest
        chosen = (inputs["x"] < bound) | (inputs["y"] > bound)
        return jnp.where(chosen, compute(yes, inputs), compute(no, inputs))
    operands = [compute(each, inputs) for each in rest]
    return (UNARY | BINARY)[kind](*operands)


def function_of(*trees) -> Function:
    """Make a function of x, y and an array z of two, with one result for each tree."""

    def call(x, y, z):
        inputs = {"x": x, "y": y, "z[0]": z[0], "z[1]": z[1]}
        results = tuple(compute(tree, inputs) for tree in trees)
        return results if len(results) > 1 else results[0]

    parameters = (
        Parameter("x", (-1.0, 1.0)),
        Parameter("y", (-1.0, 1.0)),
        Parameter("z", (-1.0, 1.0), "1", 2),
    )
    count = len(trees) if len(trees) > 1 else None
    return Function("Tree", "A random expression.", parameters, count, "results", call)


def points(count: int) -> np.ndarray:
    return np.random.default_rng(3).uniform(-1, 1, (count, 4))


def in_jax(function, rows):
    batched = jax.jit(jax.vmap(lambda *row: function.call(*group_inputs(function, row))))
    return np.stack(jax.tree.leaves(batched(*rows.T)), axis=1)


@settings(max_examples=20, deadline=None)
@given(TREES, TREES)
@pytest.mark.slow
def test_a_program_computes_what_jax_computes(one, other):
    function = function_of(one, other)
    rows = points(16)
    np.testing.assert_allclose(
        evaluate(trace(function), rows), in_jax(function, rows), rtol=0, atol=TOLERANCE["double"]
    )


@settings(max_examples=60, deadline=None)
@given(TREES)
def test_steps_of_a_program_are_distinct_and_used(tree):
    program = trace(function_of(tree))
    # Operands are compared as text, because 0.0 and -0.0 are equal but different constants.
    assert len({(step.operation, repr(step.operands)) for step in program.steps}) == len(
        program.steps
    )
    used = {o for step in program.steps for o in step.operands if isinstance(o, int)}
    used |= {o for o in program.outputs if isinstance(o, int)}
    first = len(program.inputs)
    assert used >= set(range(first, first + len(program.steps)))
    assert all(any(type(o) is int for o in step.operands) for step in program.steps)


def run_python(source, function, rows):
    names = {}
    exec(compile(source, "printed.py", "exec"), names)
    x, y, *z = rows.T
    return names[function.name](x, y, z)


@settings(max_examples=60, deadline=None)
@given(TREES, TREES, st.sampled_from(sorted(PRECISIONS)), st.sampled_from(["inline", "table"]))
def test_printed_python_equals_the_program_to_the_last_bit(one, other, precision, constants):
    function = function_of(one, other)
    rows = points(16).astype(PRECISIONS[precision])
    source = write_source(function, "python", precision, constants=constants)
    expected = evaluate(trace(function), rows, PRECISIONS[precision])
    given_back = run_python(source, function, rows)
    for result, column in zip(given_back, expected.T, strict=True):
        assert np.asarray(result).dtype == PRECISIONS[precision]
        np.testing.assert_array_equal(np.broadcast_to(result, column.shape), column)


def run_c(source, function, rows, precision):
    real = {"float": "float", "double": "double"}[precision]
    driver = f"""
void run(long n, const {real} *in, {real} *out)
{{
    for (long i = 0; i < n; ++i)
        {function.name}(in[4 * i], in[4 * i + 1], in + 4 * i + 2, out + {function.result} * i);
}}
"""
    with TemporaryDirectory() as folder:
        path = Path(folder, "printed.c")
        path.write_text(source + driver)
        # gcc warns of misleading parentheses, unused variables and shadowed names.
        flags = (
            "-std=c99 -O1 -ffp-contract=off -Wall -Wextra -Wshadow -Wno-unused-parameter -Werror"
        )
        command = [
            "gcc",
            *flags.split(),
            "-shared",
            "-fPIC",
            str(path),
            "-o",
            f"{folder}/printed.so",
            "-lm",
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr + source
        inputs = np.ascontiguousarray(rows, PRECISIONS[precision])
        outputs = np.empty((len(rows), function.result), PRECISIONS[precision])
        call = ctypes.CDLL(f"{folder}/printed.so").run
        call(ctypes.c_long(len(rows)), inputs.ctypes, outputs.ctypes)
    return outputs


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not on PATH")
@settings(max_examples=25, deadline=None)
@given(TREES, TREES, st.sampled_from(["float", "double"]), st.sampled_from(["inline", "table"]))
def test_printed_c_computes_what_the_program_does(one, other, precision, constants):
    function = function_of(one, other)
    rows = points(16).astype(PRECISIONS[precision])
    source = write_source(function, "c", precision, constants=constants)
    np.testing.assert_allclose(
        run_c(source, function, rows, precision),
        evaluate(trace(function), rows, PRECISIONS[precision]),
        rtol=0,
        atol=TOLERANCE[precision],
    )


@settings(max_examples=40, deadline=None)
@given(TREES, st.sampled_from(sorted(LANGUAGES)), st.sampled_from(["inline", "table"]))
def test_printed_lines_are_short_clean_and_reproducible(tree, language, constants):
    precision = next(iter(reversed(LANGUAGES[language].types)))
    if "double" in LANGUAGES[language].types and language in ("glsl", "hlsl", "slang"):
        precision = "float"
    source = write_source(function_of(tree), language, precision, constants=constants)
    assert source == write_source(function_of(tree), language, precision, constants=constants)
    assert source.isascii() and source.endswith("\n") and "\t" not in source
    assert max(map(len, source.splitlines())) <= 100
    assert all(line == line.rstrip() for line in source.splitlines())
    for opening, closing in ("()", "[]", "{}"):
        assert source.count(opening) == source.count(closing)


@settings(max_examples=20, deadline=None)
@given(TREES)
def test_a_value_keeps_the_name_that_checkpoint_name_gives_it(tree):
    """Where no assignment names a value, such as a clamp's, this does; values do not change."""

    def twice(value):
        return jnp.sin(value) * value

    def call(x, y, z):
        inputs = {"x": x, "y": y, "z[0]": z[0], "z[1]": z[1]}
        return twice(checkpoint_name(compute(tree, inputs) * 1.5 + jnp.cos(x), "given_name"))

    named = replace(function_of(tree), call=call)
    program, rows = trace(named), points(16)
    assert [step.hint for step in program.steps].count("given_name") == 1
    # The value is used twice, so that printed code holds it in a variable.
    assert re.search(r"\bgivenName = ", write_source(named, "python", "double"))
    np.testing.assert_allclose(
        evaluate(program, rows), in_jax(named, rows), rtol=0, atol=4 * TOLERANCE["double"]
    )
