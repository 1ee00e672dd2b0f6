"""Errors that tables in files state: those that are not their own are not believed."""

from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.packaged import packaged_table
from coefficients.stated_errors import misstatements, require_stated
from fitting import form_values
from tests.coefficients.changed import changed_table

ERRORS = packaged_table("q").errors.model_dump()
COEFFICIENTS = packaged_table("q").coefficients


def with_error(largest, **where):
    off_grid = {
        **ERRORS["off_grid"],
        "max": largest,
        "rms": min(largest, ERRORS["off_grid"]["rms"]),
    }
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
        ({"errors": with_error(ERRORS["off_grid"]["max"] * (1 - 1e-5))}, "the error at its place"),
        ({"errors": with_error(ERRORS["off_grid"]["max"] * (1 + 1e-5))}, "the error at its place"),
    ],
    ids=["coefficients", "too small", "too large", "a little too small", "a little too large"],
)
def test_a_changed_table_is_refused(tmp_path, changes, said):
    entry = resolve(changed_table(tmp_path, **changes))
    message = r"changed\.json states a largest error of .*: its coefficients or its errors were ch"
    with pytest.raises(ValueError, match=message) as error:
        require_stated(entry)
    assert said in str(error.value)


def test_a_bound_below_an_error_is_refused(tmp_path):
    largest, at = ERRORS["off_grid"]["max"], ERRORS["off_grid"]["where"]
    certificates = packaged_table("q").certificates.model_dump()
    for part in (0.9, 1.01):
        bound = {"lower": 0.0, "at": at, "upper": part * largest, "boxes": 1}
        changed = {**certificates, "largest_error": bound}
        entry = resolve(changed_table(tmp_path, certificates=changed))
        if part > 1:
            require_stated(entry)
            continue
        with pytest.raises(ValueError, match=f"but its bound is {part * largest:.4g}"):
            require_stated(entry)


@pytest.mark.parametrize(("rms", "refused"), [(0.0, True), (4e-4, True), (1e-3, False)])
def test_an_rms_error_that_is_far_too_small_is_refused(tmp_path, rms, refused):
    errors = {**ERRORS, "off_grid": {**ERRORS["off_grid"], "rms": rms}}
    entry = resolve(changed_table(tmp_path, errors=errors))
    if not refused:
        require_stated(entry)
        return
    with pytest.raises(ValueError, match=rf"its rms error of {rms:.4g} is at least 0\.004"):
        require_stated(entry)


@pytest.mark.parametrize(("part", "refused"), [(0.45, True), (0.9, True), (0.98, False)])
def test_a_true_error_at_another_place_is_not_taken_for_the_largest(tmp_path, part, refused):
    """Unless it is missed by less than a twentieth, which a search may do."""
    entry = resolve("q")
    densities = np.linspace(0.2, 0.5, 2001)
    exact = entry.problem.reference.values(densities[:, None])
    apart = np.abs(form_values(entry.require_fitted(), densities[:, None]) - exact)
    largest = ERRORS["off_grid"]["max"]
    nearest = np.argmin(np.abs(apart - part * largest))
    assert apart[nearest] == pytest.approx(part * largest, rel=0.01)
    wrong = with_error(float(apart[nearest]), density=float(densities[nearest]))
    path = changed_table(tmp_path, errors=wrong)
    if not refused:
        require_stated(resolve(path))
        return
    with pytest.raises(ValueError, match=r"but there is one of 0\.009987"):
        require_stated(resolve(path))


def test_nothing_is_said_of_tables_without_exact_values():
    entry = resolve("q")
    pair = (entry.require_fitted(), entry.require_table())
    unknown = replace(entry.problem.reference, closed_form=None, quadrature=None, monte_carlo=None)
    assert misstatements(unknown, [pair]) == [None]
    assert misstatements(unknown, []) == []
