"""Exported functions at arguments that shaders produce, but that are outside the domain.

Interpolated normals give cosines below zero and above one, a material may have any number, and u·n
and u·t may belong to no unit vector. All values are finite and within the codomain.
"""

import functools
import itertools
from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import entries, resolve
from coefficients.exported_code import programs_of, trial_of
from fitting.points.grids import sobol_points
from programs import PRECISIONS, evaluate, toolchain, write_source
from quantities import problems

TABLES = [entry.name for entry in entries()]
EXACT = [f"exact/{owner.name}" for owner in problems().values() if owner.exact_code is not None]
# One table of each form, and the closed forms: their C is compiled and run.
COMPILED = ["published/ps", "best/ps-11", "best/ps-25", "best/ps-40", "best/ps-61-wide", "g"]
COMPILED += [
    "best/g-17",
    "best/g-19",
    "best/q-12-log",
    "best/r-45",
    "velvet",
    "exact/ps",
    "exact/g",
]
# Of the results of a first function, so many different ones are given to the second.
MATERIALS = 40
ROWS = 10_000


def hostile_numbers(domain, kind):
    """Return numbers of a precision: of all sizes and both signs, and at the domain's ends."""
    info = np.finfo(kind)
    sizes = [0.0, info.smallest_subnormal, info.tiny, info.eps, 1e-4, 1e-3, 0.01, 0.15, 0.5]
    sizes += [1.0, 1.001, np.pi / 2, 2.0, 100.0, float(info.max)]
    ends = np.array([*domain, sum(domain) / 2], kind)
    beside = [np.nextafter(ends, kind(way)) for way in (-np.inf, np.inf)]
    numbers = np.concatenate([np.array(sizes, kind), -np.array(sizes, kind), ends, *beside])
    return numbers[np.isfinite(numbers)].astype(np.float64)


def hostile_rows(function, kind):
    """Return rows with all combinations of such numbers; a random part of them if they are many."""
    own = [parameter for parameter in function.parameters if parameter.size is None]
    lines = [hostile_numbers(parameter.domain, kind) for parameter in own]
    rows = np.array(list(itertools.product(*lines)))
    return rows[np.random.default_rng(1).permutation(len(rows))[:ROWS]]


def hostile_values(entry, precision, run):
    """Call the exported functions one after the other; a second one with results of the first."""
    results = None
    for number, function in enumerate(entry.functions(precision)):
        rows = hostile_rows(function, PRECISIONS[precision])
        if results is not None:
            assert np.isfinite(results).all(), f"{entry.name}: a result is not finite"
            some = np.unique(results, axis=0)
            some = some[np.random.default_rng(2).permutation(len(some))[:MATERIALS]]
            rows = np.concatenate(
                [np.repeat(some, len(rows), 0), np.tile(rows, (len(some), 1))], axis=1
            )
        results = run(number, function, rows)
    return results[:, 0]


def assert_in_codomain(values, name):
    low, high = resolve(name).problem.reference.codomain
    assert np.isfinite(values).all()
    assert low <= values.min() <= values.max() <= high


@pytest.mark.parametrize("precision", ["float", "half"])
@pytest.mark.parametrize("name", [*TABLES, *EXACT])
def test_every_finite_argument_gives_a_value_of_the_codomain(name, precision):
    programs = programs_of(resolve(name), precision)
    run = lambda number, _, rows: evaluate(programs[number], rows, PRECISIONS[precision])  # noqa: E731
    assert_in_codomain(hostile_values(resolve(name), precision, run), name)


@functools.cache
def in_c():
    if toolchain("c").missing("float") is not None:
        pytest.skip("gcc is not here")
    return toolchain("c")


@pytest.mark.parametrize("name", COMPILED)
def test_compiled_code_gives_a_value_of_the_codomain_even_for_nan(name):
    chain, entry = in_c(), resolve(name)
    source = write_source(entry.functions(), "c")
    some = np.random.default_rng(3)

    def run(_, function, rows):
        own = sum(parameter.size is None for parameter in function.parameters)
        # In C, a clamp of NaN is the upper end.
        broken = rows[: len(rows) // 10].copy()
        broken[np.arange(len(broken)), -1 - some.integers(own, size=len(broken))] = np.nan
        # `Toolchain.run` refuses NaN.
        return chain.evaluate(source, function, np.concatenate([rows, broken]), "float")

    assert_in_codomain(hostile_values(entry, "float", run), name)


@pytest.mark.parametrize("name", ["q", "velvet", *(n for n in TABLES if n.startswith("best/q"))])
def test_every_half_gives_a_value_of_the_codomain(name):
    every = np.arange(1 << 16, dtype=np.uint16).view(np.float16)
    every = every[np.isfinite(every)].astype(np.float64)
    (program,) = programs_of(resolve(name), "half")
    values = evaluate(program, every[:, None], np.float16).astype(np.float64)
    assert_in_codomain(values, name)


@pytest.mark.parametrize("name", ["published/ps", "published/ps@printed", "ps", "best/ps-40-wide"])
def test_no_point_of_the_domain_is_lost_in_half(name):
    """At some of these points, half precision would round a denominator of Eq. (2) to zero."""
    entry = resolve(name)
    points = sobol_points(entry.axes, 15, 20200718)
    run = replace(trial_of(entry, "half", 4), points=points).emulated(np.float16)
    assert_in_codomain(run, name)
