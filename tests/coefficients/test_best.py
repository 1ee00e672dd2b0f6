import functools
import itertools

import numpy as np
import pytest

from coefficients.catalogue import form_of, load, names_of_best
from coefficients.compare import compare
from coefficients.shaders import functions_of
from fitting import off_grid_errors
from fitting.improve import ENOUGH
from fitting.proofs.pole_proof import certify_denominators
from programs.cost import count
from programs.tracing.tracer import trace

BEST = names_of_best()
# Exact values of R, and boxes in four dimensions, take seconds a table.
SOME = [name if name[5] in "qg" else pytest.param(name, marks=pytest.mark.slow) for name in BEST]


@functools.cache
def operations(name: str) -> int:
    return count(trace(functions_of(load(name))[-1])).operations


def largest(name: str) -> float:
    errors = load(name).errors
    assert errors is not None
    return errors.off_grid.max


@functools.cache
def published_largest(quantity: str) -> float:
    name = f"published/{quantity}"
    return compare([(name, load(name))]).entries[0].errors.largest


def of(quantity: str) -> list[str]:
    return [name for name in BEST if load(name).quantity == quantity]


@pytest.mark.parametrize("name", SOME)
def test_a_table_states_its_errors_and_is_named_by_its_cost(name):
    table, form = load(name), form_of(load(name))
    errors = off_grid_errors(form)
    assert table.errors is not None
    assert errors.rms == pytest.approx(table.errors.off_grid.rms, rel=1e-9)
    assert errors.largest == pytest.approx(table.errors.off_grid.max, rel=1e-9)
    assert name.split("-")[1] == str(operations(name))
    assert name == f"best/{table.name}"


@pytest.mark.parametrize("name", SOME)
def test_a_table_is_certified_and_its_coefficients_are_float32(name):
    table, form = load(name), form_of(load(name))
    c = np.asarray(table.coefficients)
    np.testing.assert_array_equal(c, c.astype(np.float32).astype(float))
    assert certify_denominators(form, ENOUGH).holds


@pytest.mark.parametrize("quantity", ["q", "g", "r", "ps"])
def test_one_table_is_better_for_no_more_operations_and_one_ten_times_better(quantity):
    cost, error = operations(f"published/{quantity}"), published_largest(quantity)
    assert any(operations(name) <= cost and largest(name) < 0.9 * error for name in of(quantity))
    assert any(largest(name) <= 0.1 * error for name in of(quantity))


@pytest.mark.parametrize(
    ("quantity", "budget", "most"),
    [
        ("q", 9, 2e-5),
        ("g", 13, 5e-3),
        ("r", 36, 1e-4),
        ("ps", 15, 0.067),
        ("ps", 25, 0.0155),
        ("ps", 40, 2.5e-3),
    ],
)
def test_an_error_is_reached_within_a_budget(quantity, budget, most):
    assert any(operations(name) <= budget and largest(name) <= most for name in of(quantity))


def test_tables_for_the_whole_domain_reach_upright_fibres_and_low_alpha():
    for quantity, most in (("ps", 5e-3), ("r", 1e-4)):
        wide = [name for name in of(quantity) if load(name).arguments[0].domain[0] <= 0.05]
        assert min(largest(name) for name in wide) <= most
        for name in wide:
            assert load(name).arguments[1].domain == [0.0, np.pi / 2]


@pytest.mark.parametrize("quantity", ["q", "g", "r", "ps"])
def test_more_operations_never_buy_a_larger_error(quantity):
    # Of one domain: a wider one costs error.
    narrow = [name for name in of(quantity) if not name.endswith("-wide")]
    # Those with more structure, or no exponential, are kept for that.
    ranked = [n for n in sorted(narrow, key=operations) if n[5:] not in ("g-19", "q-5")]
    errors = [largest(name) for name in ranked]
    assert sorted(errors) == sorted(set(errors))
    for one, other in itertools.pairwise(ranked):
        assert operations(one) == operations(other) or largest(other) < largest(one)
