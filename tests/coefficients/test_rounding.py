"""Rounding of exported code: the proven bounds, and the compiled code itself."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.exported_code import trial_of
from coefficients.proof_text import rounding_text
from coefficients.rounding import arguments_of, certify_rounding, with_rounding
from coefficients.table import parse, serialise
from fitting.proofs.rounding_error import TracedArguments, rounded_box, rounding_kernel
from integrals.reference import Axis
from programs import evaluate, trace, write_source
from programs.bounding.compiled import compiler_missing
from programs.bounding.rounding import chained
from programs.bounding.rounding_model import IEEE
from programs.toolchains.difference import difference
from programs.toolchains.verification import run_code

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

QUICK = ["best/q-9", "best/g-17"]
SLOW = ["velvet", "best/r-25", "best/ps-11", "q", "g", "r"]


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(n, marks=pytest.mark.slow) for n in SLOW)])
def test_the_compiled_code_keeps_the_bound_and_comes_near_it(name):
    entry = resolve(name)
    found = certify_rounding(entry, models=["ieee"])
    trial = trial_of(entry, "float")
    values = run_code(trial, "c", write_source(trial.calls.functions, "c"))
    largest = max(difference(values, trial.form).largest, found.measured)
    upper = found.found["ieee"].upper
    assert found.state == "proven" and largest <= upper <= 10 * largest


def test_bounds_are_written_and_stated():
    found = certify_rounding(resolve("best/q-4"))
    table = parse(serialise(with_rounding(found)), "q-4")
    record = table.certificates.float32_rounding
    assert record.ieee.upper == found.found["ieee"].upper < record.vulkan.upper
    changed = resolve("best/q-4")
    object.__setattr__(changed, "table", table)
    text = rounding_text(changed, 1.23e-7, 1000)
    assert text.startswith("proven: at most 2.2e-07 (IEEE 754 arithmetic")
    assert text.endswith("measured: at most 1.3e-07 more error at 1000 points")


def test_a_published_table_has_no_certificates_to_write():
    found = certify_rounding(resolve("published/q"), models=["ieee"])
    assert found.state == "proven"
    with pytest.raises(ValueError, match="published/q is published"):
        with_rounding(found)


@pytest.mark.slow
def test_long_code_is_not_proven_but_measured():
    found = certify_rounding(resolve("exact/g"))
    assert found.state == "not proven" and found.found == {"ieee": None, "vulkan": None}
    assert 0 < found.measured < 1e-5
    with pytest.raises(ValueError, match="has no coefficients"):
        with_rounding(found)


@pytest.mark.slow
def test_arguments_of_proofs_are_those_of_the_code():
    """At a point of the variables, they are what the code is verified with."""
    for name in ("best/ps-11", "exact/ps", "exact/g", "best/r-25"):
        entry = resolve(name)
        given = arguments_of(entry)
        points = np.stack([axis.place(np.array(0.3)) for axis in entry.axes])[None]
        own = [float(axis.place(np.array(0.3))) for axis in entry.axes]
        if name.endswith(("ps", "ps-11")):
            points[0, 3], own[3] = 2.0, np.cos(2.0)
        expected = np.concatenate(entry.arguments_at(points), axis=1)[0]
        np.testing.assert_allclose([float(x) for x in given.call(*own)], expected, atol=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["best/ps-11", "best/ps-61-wide", "exact/ps", "best/g-17"])
def test_the_bound_holds_at_each_point_even_where_it_is_not_proven_on_boxes(name):
    """The search cannot divide the whole domain of forms with Newton steps, but points it can."""
    entry = resolve(name)
    functions, given = entry.functions("float"), arguments_of(entry)
    kernel = rounding_kernel(functions, given, IEEE)
    program, rng = chained([trace(each) for each in functions]), np.random.default_rng(4)
    low, high = rounded_box(given).T
    points = low + (high - low) * rng.random((3000, len(low))) ** 2
    inputs = np.array(jax.vmap(lambda x: jnp.stack(given.call(*x)))(jnp.asarray(points)))
    inputs = inputs.astype(np.float32).astype(float)
    if not any(given.rounded):
        points = np.clip(inputs[:, [1, 0]], low, high)
    single = evaluate(program, inputs, np.float32).astype(float)
    moved = np.abs(single - evaluate(program, inputs))[:, 0]
    bounds = np.array([kernel.enclose(np.stack([x, x], axis=1))[1] for x in points])
    assert np.all(moved <= bounds)
    assert bounds.max() <= 40 * moved.max()


def test_the_box_has_the_domain_and_its_ends_in_float32():
    sides = (Axis("a", 0.1, 0.2, meaning="a"), Axis("b", -0.3, 1.0, meaning="b"))
    box = rounded_box(TracedArguments(sides, lambda a, b: (a, b), (False, False)))
    assert box.shape == (2, 2)
    single = [[float(np.float32(x)) for x in (axis.lower, axis.upper)] for axis in sides]
    for axis, rounded, side in zip(sides, single, box.tolist(), strict=True):
        assert side == [min(axis.lower, rounded[0]), max(axis.upper, rounded[1])]
    assert box[0].tolist() != [0.1, 0.2]


def test_an_infinite_domain_is_refused():
    entry = resolve("best/q-9")
    given = arguments_of(entry)
    infinite = TracedArguments((Axis("d", 0.0, np.inf, meaning="d"),), given.call, given.rounded)
    with pytest.raises(ValueError, match="a domain is infinite"):
        rounding_kernel(entry.functions("float"), infinite, IEEE)
