import json
from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import form_of, load, names
from coefficients.compare import as_json, coefficient_rows, compare
from coefficients.table import Table, parse, serialise
from fitting import Domain, common_domain, form_values, off_grid_errors, off_grid_reference
from integrals import Q

QUANTITIES = ("ps", "g", "q", "r")


def against_published(quantity: str):
    return compare([(name, load(name)) for name in (f"published/{quantity}", quantity)])


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_refit_is_no_worse_than_the_corrected_published_table(quantity):
    published, refitted = against_published(quantity).entries
    assert published.rms_ratio == published.largest_ratio == 1
    assert refitted.rms_ratio < 1
    assert refitted.rms_ratio == refitted.errors.rms / published.errors.rms
    assert refitted.largest_ratio == refitted.errors.largest / published.errors.largest


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_table_is_measured_on_the_points_that_refits_are_measured_on(quantity):
    found = against_published(quantity)
    for entry in found.entries:
        expected = off_grid_errors(form_of(entry.table))
        assert entry.errors.rms == pytest.approx(expected.rms, rel=1e-12)
        assert entry.errors.where == expected.where
    # … so that a table's own statement of its errors is confirmed.
    stated = found.entries[1].table.errors.off_grid
    measured = found.entries[1].errors
    assert (measured.largest, measured.where) == (pytest.approx(stated.max, rel=1e-9), stated.where)
    assert measured.rms == pytest.approx(stated.rms, rel=1e-9)


def test_where_tables_differ_most_is_found():
    found = against_published("g")
    one, other = (form_of(entry.table) for entry in found.entries)
    points, _ = off_grid_reference(type(one))
    apart = np.abs(form_values(one, points) - form_values(other, points))
    assert found.difference == apart.max()
    assert list(found.where.values()) == points[apart.argmax()].tolist()
    place = np.array([list(found.where.values())])
    at = abs(form_values(one, place) - form_values(other, place))[0]
    assert at == pytest.approx(found.difference, rel=1e-12)


def test_the_last_of_three_is_held_against_the_first():
    labels = ("published/ps", "published/ps@printed", "ps")
    found = compare([(name, load(name)) for name in labels])
    assert tuple(entry.label for entry in found.entries) == labels
    assert found.entries[1].rms_ratio > 4
    assert found.difference == against_published("ps").difference


def narrow(lower: float) -> Table:
    """Give a table of R for other α: the coefficients are nearly right there too."""
    data = json.loads(serialise(load("best/r-25")))
    data["arguments"][0]["domain"][0] = lower
    data["shape"]["least_alpha"] = lower
    return parse(json.dumps(data), "itself")


def test_tables_are_measured_where_both_are_defined():
    one, other = load("published/r"), narrow(0.3)
    found = compare([("one", one), ("other", other)])
    turned = compare([("other", other), ("one", one)])
    assert found.domain == turned.domain
    assert as_json(found)["domain"] == {"alpha": [0.3, 1.0], "theta_f": [0.0, np.pi / 2]}
    assert found.entries[0].errors == turned.entries[1].errors
    # The largest error of the published table is below α = 0.3.
    assert compare([("one", one)]).entries[0].errors.where["alpha"] < 0.3
    points, exact = off_grid_reference(found.domain)
    assert points[:, 0].min() >= 0.3
    for table, entry in zip((one, other), found.entries, strict=True):
        assert entry.errors.where["alpha"] >= 0.3
        difference = form_values(form_of(table), points) - exact
        assert entry.errors.rms == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-12)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_published_tables_are_measured_on_their_whole_domain_beside_all_others(quantity):
    published = type(form_of(load(f"published/{quantity}")))
    every = [type(form_of(table)) for table in map(load, names()) if table.quantity == quantity]
    assert len(every) > 2
    assert common_domain(every).axes == published.axes


def test_domains_without_a_common_part_are_refused():
    below = Domain(Q, (replace(Q.axes[0], upper=0.2),))
    above = Domain(Q, (replace(Q.axes[0], lower=0.2, upper=0.5),))
    with pytest.raises(ValueError, match=r"density .* in common: \[0, 0.2\] and \[0.2, 0.5\]$"):
        common_domain([below, above])
    assert common_domain([above, above]) == above


def test_a_table_does_not_differ_from_itself():
    found = compare([("one", load("q")), ("other", load("q"))])
    assert (found.difference, found.entries[1].rms_ratio) == (0, 1)


def test_a_single_table_is_measured():
    found = compare([("q", load("q"))])
    assert found.entries[0].errors.rms == pytest.approx(load("q").errors.off_grid.rms, rel=1e-9)


def test_tables_of_different_quantities_are_refused():
    with pytest.raises(ValueError, match="different quantities: g, q"):
        compare([("one", load("q")), ("other", load("g"))])


def test_a_comparison_of_nothing_is_refused():
    with pytest.raises(ValueError):
        compare([])


@pytest.mark.parametrize("quantity", ["ps", "q"])
def test_a_comparison_is_plain_json(quantity):
    found = against_published(quantity)
    data = as_json(found)
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    assert data["quantity"] == quantity
    assert data["points"] == found.entries[0].errors.points
    refitted = data["tables"][1]
    assert refitted["coefficients"] == load(quantity).coefficients
    assert (refitted["rms"], refitted["max"]) == (
        found.entries[1].errors.rms,
        found.entries[1].errors.largest,
    )
    assert data["largest_difference"] == {"value": found.difference, "where": found.where}


@pytest.mark.parametrize(("quantity", "count"), [("ps", 162), ("g", 4), ("q", 2), ("r", 17)])
def test_coefficients_stand_side_by_side_under_their_names(quantity, count):
    found = against_published(quantity)
    rows = coefficient_rows(found)
    assert len(rows) == count
    labels, values = zip(*rows, strict=True)
    assert list(labels) == np.ravel(found.entries[0].table.coefficient_names).tolist()
    for column, entry in enumerate(found.entries):
        expected = np.ravel(entry.table.coefficients).tolist()
        assert [row[column] for row in values] == expected
