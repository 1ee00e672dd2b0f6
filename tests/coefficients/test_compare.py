"""Tables side by side on the same points."""

import functools
import json

import numpy as np
import pytest

from coefficients.catalogue import Entry, entries, resolve
from coefficients.compare import coefficient_rows, compare
from coefficients.table import serialise
from fitting import common_domain, form_values, judge
from fitting.points.scattered import judging_points
from quantities import problem

QUANTITIES = ("ps", "g", "q", "r")


def of(*names: str):
    return compare([(name, resolve(name)) for name in names])


@functools.cache
def against_published(quantity: str):
    return of(f"published/{quantity}", quantity)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_refit_is_no_worse_than_the_corrected_published_table(quantity):
    found = against_published(quantity)
    published, refitted = found.contestants
    assert published.rms_ratio == published.largest_ratio == 1
    assert refitted.rms_ratio < 1
    assert refitted.rms_ratio == refitted.errors.rms / published.errors.rms
    assert refitted.largest_ratio == refitted.errors.largest / published.errors.largest
    # The refitted table's own statement of its errors is confirmed.
    stated, measured = refitted.table.errors.off_grid, refitted.errors
    assert measured.rms == pytest.approx(stated.rms, rel=1e-9)
    assert measured.largest == pytest.approx(stated.max, rel=1e-9)


@pytest.mark.parametrize("quantity", ["g", "q"])
def test_every_table_is_measured_on_the_points_that_refits_are_measured_on(quantity):
    for each in against_published(quantity).contestants:
        expected = judge(resolve(each.label).require_fitted())
        assert each.errors.rms == pytest.approx(expected.rms, rel=1e-12)
        assert each.errors.where == expected.where


def test_where_tables_differ_most_is_found():
    found = against_published("g")
    one, other = (resolve(each.label).require_fitted() for each in found.contestants)
    points, _ = judging_points(one.form)
    apart = np.abs(form_values(one, points) - form_values(other, points))
    assert found.difference == apart.max()
    assert list(found.where.values()) == points[apart.argmax()].tolist()
    place = np.array([list(found.where.values())])
    at = abs(form_values(one, place) - form_values(other, place))[0]
    assert at == pytest.approx(found.difference, rel=1e-12)


def test_the_last_of_three_is_compared_with_the_first():
    labels = ("published/ps", "published/ps@printed", "ps")
    found = of(*labels)
    assert tuple(each.label for each in found.contestants) == labels
    assert found.contestants[1].rms_ratio > 4
    assert found.difference == against_published("ps").difference


@pytest.fixture
def narrow(tmp_path) -> Entry:
    """A table of R for α ≥ 0.3 only: the coefficients are nearly right there too."""
    data = json.loads(serialise(resolve("best/r-25").require_table()))
    data["arguments"][0]["domain"][0] = 0.3
    data["shape"]["least_alpha"] = 0.3
    path = tmp_path / "narrow.json"
    path.write_text(json.dumps(data))
    return resolve(str(path))


def test_tables_are_measured_where_both_are_defined(narrow):
    one = resolve("published/r")
    found = compare([("one", one), ("other", narrow)])
    turned = compare([("other", narrow), ("one", one)])
    assert found.domain == turned.domain
    ends = {axis.name: (axis.lower, axis.upper) for axis in found.domain.axes}
    assert ends == {"alpha": (0.3, 1.0), "theta_f": (0.0, np.pi / 2)}
    assert found.contestants[0].errors == turned.contestants[1].errors
    # The largest error of the published table is below α = 0.3.
    assert compare([("one", one)]).contestants[0].errors.where["alpha"] < 0.3
    points, exact = judging_points(found.domain)
    assert points[:, 0].min() >= 0.3
    for entry, each in zip((one, narrow), found.contestants, strict=True):
        assert each.errors.where["alpha"] >= 0.3
        difference = form_values(entry.require_fitted(), points) - exact
        assert each.errors.rms == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-12)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_published_tables_are_measured_on_their_whole_domain_beside_all_others(quantity):
    every = [entry.require_fitted().form for entry in entries(problem(quantity))]
    assert len(every) > 2
    assert common_domain(every).axes == problem(quantity).default.axes


def test_a_table_does_not_differ_from_itself():
    found = of("q", "q")
    assert (found.difference, found.contestants[1].rms_ratio) == (0, 1)


def test_a_single_table_is_measured():
    (found,) = of("q").contestants
    stated = resolve("q").require_table().errors.off_grid
    assert found.errors.rms == pytest.approx(stated.rms, rel=1e-9)


def test_tables_of_different_quantities_are_refused():
    with pytest.raises(ValueError, match="different quantities: g, q"):
        of("q", "g")


def test_a_closed_form_is_no_table_to_compare():
    with pytest.raises(ValueError, match="exact/q has no coefficients"):
        of("q", "exact/q")


def test_a_comparison_of_nothing_is_refused():
    with pytest.raises(ValueError):
        compare([])


@pytest.mark.parametrize(("quantity", "count"), [("ps", 162), ("g", 4), ("q", 2), ("r", 17)])
def test_coefficients_stand_side_by_side_under_their_names(quantity, count):
    found = against_published(quantity)
    rows = coefficient_rows(found)
    assert len(rows) == count
    labels, values = zip(*rows, strict=True)
    assert list(labels) == np.ravel(found.contestants[0].table.coefficient_names).tolist()
    for column, each in enumerate(found.contestants):
        expected = np.ravel(each.table.coefficients).tolist()
        assert [row[column] for row in values] == expected
