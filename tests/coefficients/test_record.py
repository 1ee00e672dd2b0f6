"""A fit, written down as a table."""

import math
from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import FOLDER
from coefficients.record import table_of
from coefficients.table import parse, serialise
from fitting import Errors, Fit, Goal
from fitting.fit import fit
from fitting.points.grids import gauss_grid
from fitting.points.sample import sample_of
from fitting.proofs.local_optimality import LocalOptimality
from programs import DenominatorBound
from programs.bounding.branch_and_bound import Bounds
from quantities import problem
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G

G = RATIONAL_G.fitted(np.array([-0.9, 0.4, 0.7, -0.26]))
Q = QUADRATIC_Q.fitted(np.array([-1.7, 1.2]))


def fit_of(fitted, bound: float = 0.5) -> Fit:
    """Return a fit with made-up results, to be written down."""
    where = {axis.name: axis.lower for axis in fitted.axes}
    return Fit(
        fitted=fitted,
        grid=gauss_grid(fitted.axes, 9),
        measure="uniform",
        inner=7,
        solver="by hand",
        reference_error=1e-15,
        on_grid=Errors(0.1, 0.2, where, 81),
        off_grid=Errors(0.3, 0.4, where, 99),
        certificate=DenominatorBound(bound, 11),
    )


def test_a_fit_is_written_down_whole():
    table = table_of(fit_of(G), "make it")
    assert table.coefficients == G.constants.tolist()
    assert (table.name, table.form, table.equation) == (
        "g",
        "rational-g",
        "G = d·(1 + ν·(c0 + ν·c1))/(d + ν·(c2 + ν²·c3))",
    )
    assert (table.quantity, table.shape, table.goal) == ("g", None, None)
    assert [(n.argument, n.count, n.spacing) for n in table.grid.nodes] == [
        ("density", 9, "gauss-legendre"),
        ("cos_v", 9, "gauss-legendre"),
    ]
    assert (table.grid.directions, table.grid.points, table.weight) == (7, None, "uniform")
    assert (table.reference.leg, table.reference.error) == ("closed_form", 1e-15)
    on, off = table.errors.on_grid, table.errors.off_grid
    assert (on.rms, on.max, on.points, off.rms, off.max, off.points) == (0.1, 0.2, 81, 0.3, 0.4, 99)
    assert on.where == {"density": 0.001, "cos_v": 0.001}
    certificates = table.certificates
    assert (certificates.denominator_bound, certificates.boxes) == (0.5, 11)
    assert certificates.range is certificates.least_error is certificates.conservative_bound is None
    assert (table.provenance.command, table.provenance.solver) == ("make it", "by hand")
    assert table.provenance.versions["jax"] == "0.10.2"
    assert parse(serialise(table), "itself") == table


def test_what_is_proven_besides_is_written_down_where_it_is_known():
    goal = Goal("linf", rounding="float32")
    proven = replace(fit_of(Q), goal=goal, range=Bounds(0.25, 1.0, 3), least_error=0.39, below=1e-7)
    near = replace(fit_of(Q), local_optimality=LocalOptimality(0.002, 3))
    stated = table_of(near, "make it").certificates.local_optimality
    assert (stated.decrease, stated.extrema) == (0.002, 3)
    table = table_of(proven, "make it", "mine")
    assert table.name == "mine"
    assert Goal(**table.goal.model_dump()) == goal
    certificates = table.certificates
    assert (certificates.range, certificates.least_error) == ([0.25, 1.0], 0.39)
    assert certificates.conservative_bound == 1e-7
    assert certificates.local_optimality is None


def test_a_fit_to_scattered_points_has_their_number_instead_of_nodes():
    sample = sample_of(QUADRATIC_Q)
    table = table_of(replace(fit_of(Q), grid=sample, inner=0), "make it")
    assert (table.grid.nodes, table.grid.points) == ([], len(sample.points))


def test_a_form_of_a_family_is_written_down_with_its_shape():
    form = problem("g").find_form("tied-g", {"poles": 1, "root": 0})
    table = table_of(fit_of(form.fitted(np.array([2.5, 0.1, 0.05]))), "make it")
    assert (table.form, table.shape) == ("tied-g", {"poles": 1, "root": 0})


def test_a_form_without_denominators_has_no_bound_in_its_table():
    table = table_of(fit_of(Q, math.inf), "make it")
    assert table.certificates.denominator_bound is None
    assert "denominator_bound" not in serialise(table)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_fit_with_values_that_are_not_finite_is_not_written_down(bad):
    good = fit_of(Q)
    with pytest.raises(ValueError, match="no JSON number"):
        table_of(replace(good, fitted=QUADRATIC_Q.fitted(np.array([bad, 1.2]))), "make it")
    with pytest.raises(ValueError, match="no JSON number"):
        table_of(replace(good, off_grid=Errors(bad, 0.4, {"density": 0.1}, 9)), "make it")


def test_nothing_in_a_table_tells_when_or_where_it_was_made(monkeypatch, tmp_path):
    first = serialise(table_of(fit_of(Q), "make it"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert serialise(table_of(fit_of(Q), "make it")) == first
    assert str(FOLDER) not in first


def test_the_same_fit_twice_is_the_same_table_byte_for_byte():
    one, other = (serialise(table_of(fit(QUADRATIC_Q, nodes=9), "again")) for _ in range(2))
    assert one == other
