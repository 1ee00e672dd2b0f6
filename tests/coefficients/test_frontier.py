"""What evaluations cost against how wrong they are."""

import numpy as np
import pytest

from coefficients.catalogue import entries, resolve
from coefficients.compare import compare
from coefficients.exported_code import operations_of
from coefficients.frontier import Mark, best_so_far, closed_form, marks
from fitting.points.scattered import judging_points
from quantities import problem


def mark(name: str, operations: int, largest: float) -> Mark:
    return Mark(name, "best", operations, largest, largest / 3)


def test_only_marks_that_no_other_beats_are_on_the_frontier():
    every = [mark("c", 9, 1e-3), mark("a", 4, 1e-2), mark("worse", 6, 2e-2), mark("b", 6, 1e-3)]
    assert [each.name for each in best_so_far(every)] == ["a", "b"]
    assert best_so_far([]) == []


def test_of_equal_marks_the_first_by_name_is_on_the_frontier():
    assert [m.name for m in best_so_far([mark("b", 4, 1e-2), mark("a", 4, 1e-2)])] == ["a"]


@pytest.mark.parametrize("quantity", ["q", "g"])
def test_every_table_and_the_closed_form_have_a_mark(quantity):
    owner = problem(quantity)
    found = {each.name: each for each in marks(owner)}
    tables = [entry.name for entry in entries(owner)]
    assert set(found) == {*tables, "closed form"}
    for entry in entries(owner):
        assert found[entry.name].kind == entry.kind
        assert found[entry.name].operations == operations_of(entry)
    # All are measured on the domain of the published table.
    pair = [(each, resolve(each)) for each in (f"published/{quantity}", tables[-1])]
    errors = compare(pair).contestants[1].errors
    assert (found[tables[-1]].largest, found[tables[-1]].rms) == (errors.largest, errors.rms)


def test_the_closed_form_is_as_good_as_float32():
    (found,) = closed_form(problem("q"))
    assert (found.name, found.kind) == ("closed form", "exact")
    assert 1e-9 < found.rms < found.largest < 1e-5
    points, _ = judging_points(resolve("published/q").require_fitted().form)
    assert points.dtype == np.float64


def test_r_has_no_closed_form():
    assert closed_form(problem("r")) == []


def test_where_nothing_is_published_marks_have_the_stated_errors():
    (found,) = marks(problem("velvet"))
    stated = resolve("velvet").require_table().errors.off_grid
    assert (found.name, found.largest, found.rms) == ("velvet", stated.max, stated.rms)
