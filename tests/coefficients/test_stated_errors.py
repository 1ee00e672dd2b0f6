"""Errors that tables in files state: those that are not their own are not believed."""

import re
from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.packaged import packaged_table
from coefficients.stated_errors import misstatements, require_stated
from tests.coefficients.changed import changed_table

ERRORS = packaged_table("q").errors.model_dump()
COEFFICIENTS = packaged_table("q").coefficients


def with_error(largest, **where):
    off_grid = {**ERRORS["off_grid"], "max": largest, "rms": min(largest, 1e-4)}
    return {**ERRORS, "off_grid": {**off_grid, "where": where or off_grid["where"]}}


def test_a_table_as_it_was_made_is_accepted(tmp_path):
    require_stated(resolve(changed_table(tmp_path)))
    require_stated(resolve(changed_table(tmp_path, errors=None)))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"coefficients": [COEFFICIENTS[0] * 1.001, COEFFICIENTS[1]]}, "the error at its place is"),
        ({"errors": with_error(1e-3)}, "the error at its place is 0.01"),
        ({"errors": with_error(0.5)}, "the error at its place is 0.01"),
    ],
    ids=["coefficients", "too small", "too large"],
)
def test_a_changed_table_is_refused(tmp_path, changes, said):
    entry = resolve(changed_table(tmp_path, **changes))
    message = r"changed\.json states a largest error of .*: its coefficients or its errors were ch"
    with pytest.raises(ValueError, match=message) as error:
        require_stated(entry)
    assert said in str(error.value)


def test_a_true_error_at_another_place_is_not_taken_for_the_largest(tmp_path):
    entry = resolve("q")
    fitted = entry.require_fitted()
    density = 0.31
    exact = entry.problem.reference.values(np.array([[density]]))[0]
    there = abs(float(fitted(density)) - exact)
    assert there < 0.5 * ERRORS["off_grid"]["max"]
    path = changed_table(tmp_path, errors=with_error(there, density=density))
    with pytest.raises(ValueError, match=re.escape("but there is one of 0.009")):
        require_stated(resolve(path))


def test_nothing_is_said_of_tables_without_exact_values():
    entry = resolve("q")
    pair = (entry.require_fitted(), entry.require_table())
    unknown = replace(entry.problem.reference, closed_form=None, quadrature=None, monte_carlo=None)
    assert misstatements(unknown, [pair]) == [None]
    assert misstatements(unknown, []) == []
