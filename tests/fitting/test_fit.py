"""Fits as a whole: from exact values to a certified form, on the domains of the forms in print."""

import functools
import subprocess
import sys
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Fit, Goal, form_values
from fitting.errors import OFF_GRID_SEED
from fitting.fit import fit
from fitting.points.grids import trapezoid_grid
from fitting.points.scattered import checking_points, judging_points
from fitting.proofs.pole_proof import certify_denominators
from fitting.solvers import exchange
from fitting.solvers.on_grid import OnGrid
from integrals.fuzz.ps import MEASURES
from quantities import problem
from quantities.fuzz.lights import light_directions
from quantities.fuzz.supplement import LIGHTS_PER_ANGLE, QUADRATIC_Q, RATIONAL_PS, RATIONAL_R

SMALL = 17
THETA_U = RATIONAL_PS.axes[2]


@functools.cache
def made(name: str, nodes: int) -> Fit:
    return fit(problem(name).default, nodes=nodes)


def require_stated_errors_off_the_grid(found: Fit) -> None:
    fitted, errors = found.fitted, found.off_grid
    points, exact = judging_points(fitted.form)
    difference = form_values(fitted, points) - exact
    assert errors.rms == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-12)
    # The largest is sought on the boundary too.
    points, exact = checking_points(fitted.form, OFF_GRID_SEED)
    boundary = form_values(fitted, points) - exact
    largest = max(np.abs(difference).max(), np.abs(boundary).max())
    # Hill climbing finds a larger one, but not by much.
    assert largest * (1 - 1e-12) <= errors.largest < 1.02 * largest
    place = np.array([list(errors.where.values())])
    there = form_values(fitted, place) - fitted.reference.values(place)
    assert abs(there[0]) == pytest.approx(errors.largest, rel=1e-9)
    assert list(errors.where) == [axis.name for axis in fitted.axes]


def require_stated_errors_on_the_grid(found: Fit, nodes: int) -> None:
    points = found.grid.points
    difference = form_values(found.fitted, points) - found.fitted.reference.values(points)
    rms = np.sqrt(found.grid.weights @ difference**2)
    assert found.on_grid.rms == pytest.approx(rms, rel=1e-9)
    assert found.on_grid.largest == pytest.approx(np.abs(difference).max(), rel=1e-9)
    assert found.on_grid.points == len(points) == nodes ** len(found.grid.axes)
    assert (found.inner, found.measure) == (0, "uniform")


# The checks of one fit are one test: a fit takes up to twenty seconds.
@pytest.mark.parametrize(
    ("name", "nodes", "least"),
    # Denominators are not only just positive: G's ends at d = 0.001.
    [("g", 33, 0.0015), ("q", 65, np.inf), ("r", SMALL, 0.1)],
)
def test_a_fit_is_certified_and_states_its_errors(name, nodes, least):
    found = made(name, nodes)
    require_stated_errors_off_the_grid(found)
    require_stated_errors_on_the_grid(found, nodes)
    assert found.certificate.holds
    assert found.certificate.bound >= least
    # The exact values are far better than the fit.
    assert 0 < found.reference_error < 0.003 * found.off_grid.rms


@pytest.mark.slow
@pytest.mark.parametrize("nodes", [SMALL, 65])
def test_the_fit_of_p_s_is_within_one_per_cent_of_what_any_coefficients_can_do(nodes):
    found = made("ps", nodes)
    require_stated_errors_off_the_grid(found)
    assert found.certificate.holds
    # The denominator of c₂ is kept at about 0.02.
    assert found.certificate.bound >= 0.01
    assert 0 < found.reference_error < 0.003 * found.off_grid.rms
    assert found.inner == LIGHTS_PER_ANGLE**2
    best = RATIONAL_PS.solver.node_fits(RATIONAL_PS, found.grid, "uniform")
    limit = np.sqrt(found.grid.weights @ np.ravel(best.residuals))
    assert limit < found.on_grid.rms < 1.01 * limit
    # The form of P_s in print leaves [0, 1].
    assert found.range is None


def test_what_is_proven_of_a_fit_is_kept_with_it():
    velvet = fit(problem("velvet").default, nodes=17)
    assert velvet.below is not None and velvet.below > 0
    assert velvet.goal == Goal("linf", relative=True, side="below")
    q = made("q", 65)
    assert (q.below, q.least_error, q.goal) == (None, None, Goal())
    assert q.range is not None and 0 <= q.range.lower < q.range.upper <= 1 + 1e-12


def test_a_goal_beyond_least_squares_is_pursued_from_the_fit_on_the_grid():
    found, squares = fit(QUADRATIC_Q, Goal("linf"), nodes=17), made("q", 65)
    assert found.off_grid.largest < 0.8 * squares.off_grid.largest
    assert found.least_error is not None
    assert 0.99 * found.on_grid.largest < found.least_error <= found.on_grid.largest
    assert "linear programs" in found.solver


def test_a_form_without_coefficients_is_measured_and_certified():
    shape = {"steps": 0, "degree": -1, "least_alpha": 0.15}
    found = fit(problem("ps").find_form("cubic-ps", shape), Goal("linf", rounding="float32"))
    assert found.certificate.holds
    assert 0.01 < found.off_grid.largest < 0.0125
    assert found.fitted.form.size == 0


def test_the_same_fit_twice_has_the_same_coefficients_to_the_last_bit():
    one, other = (fit(QUADRATIC_Q, nodes=9).fitted.constants for _ in range(2))
    np.testing.assert_array_equal(one, other)


def test_the_floor_of_fits_cannot_know_the_tables():
    """Nothing that a fit imports belongs to the floors above."""
    code = (
        "import sys, fitting.fit, fitting.greedy_monomials; "
        "print([m for m in sys.modules if m.split('.')[0] in ('coefficients', 'quantities')])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout == "[]\n"


# Other choices


@pytest.mark.slow
@pytest.mark.parametrize("measure", [each for each in MEASURES if each != "uniform"])
def test_a_fit_is_better_in_its_own_measure(measure):
    """Each fit of P_s is better in its own measure than the one that was made in the angles."""
    weighted, uniform = fit(RATIONAL_PS, nodes=SMALL, measure=measure), made("ps", SMALL)
    assert weighted.measure == measure
    lights, weights = light_directions(24, measure)
    rms = []
    for found in (weighted, uniform):
        square = 0.0
        for material, share in zip(found.grid.points, found.grid.weights, strict=True):
            points = np.concatenate([np.broadcast_to(material, lights.shape), lights], axis=1)
            difference = form_values(found.fitted, points) - RATIONAL_PS.reference.values(points)
            square += share * (weights @ difference**2)
        rms.append(np.sqrt(square))
    assert rms[0] == pytest.approx(weighted.on_grid.rms, rel=1e-3)
    # Measured: 1.2 % in solid angle, where both are near the limit, and more by cosine.
    assert rms[0] < 0.99 * rms[1]


@pytest.mark.slow
@pytest.mark.parametrize("nodes", [9, 16, 34, 129])
def test_other_grids_of_p_s_give_certified_fits_too(nodes):
    found = fit(RATIONAL_PS, nodes=nodes)
    assert found.certificate.holds
    assert found.off_grid.rms < 0.0112


@pytest.mark.parametrize("nodes", [None, 17])
def test_a_quantity_that_does_not_have_a_measure_weighs_its_errors_equally(nodes):
    plain, weighted = (fit(QUADRATIC_Q, nodes=nodes, measure=m) for m in ("uniform", "cosine"))
    np.testing.assert_array_equal(plain.fitted.constants, weighted.fitted.constants)
    assert weighted.measure == "uniform"


# What is refused


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        (1, "grid = 1: allowed are 9 to 1025 nodes an axis"),
        (8, "grid = 8"),
        (0, "grid = 0"),
        (-65, "grid = -65"),
        (1026, "grid = 1026"),
        (10**30, "grid = 1"),
    ],
)
def test_a_grid_that_cannot_be_fitted_is_refused(nodes, message):
    with pytest.raises(ValueError, match=message):
        fit(QUADRATIC_Q, nodes=nodes)


@pytest.mark.parametrize("nodes", [None, 17])
def test_an_unknown_measure_is_refused(nodes):
    with pytest.raises(ValueError, match="weight = 'sine': allowed are uniform, solid-angle, cos"):
        fit(RATIONAL_PS, nodes=nodes, measure="sine")


# 1 + qᵀy with a zero at a node (θf = π/2, δ = 1), and one that is on no node of any grid
POLES = {"at a node": [0.0, 0.0, -1.0], "between": [0.0, -np.cos(0.7), -np.sin(0.7)]}


@pytest.mark.parametrize("where", POLES)
def test_a_fit_with_a_pole_is_refused(where):
    coefficients = jnp.array([0.3, *[0.0] * 13, *POLES[where]])
    solver = OnGrid(trapezoid_grid, lambda grid, exact: coefficients, "none")
    with pytest.raises(ValueError, match="fit of r on 9 nodes has a denominator that is not posit"):
        fit(replace(RATIONAL_R, solver=solver), nodes=9)


def test_a_fit_to_scattered_points_that_is_not_certified_is_refused(monkeypatch):
    nothing = type(certify_denominators(QUADRATIC_Q.fitted(np.ones(2))))(-np.inf, 1)
    monkeypatch.setattr("fitting.fit.certify_denominators", lambda *_: nothing)
    with pytest.raises(ValueError, match="quadratic-q has a value that is not shown to be finite"):
        fit(QUADRATIC_Q)


def test_a_fit_from_below_that_is_not_proven_to_be_is_refused():
    form = problem("velvet").default
    unproven = replace(form, proofs=replace(form.proofs, below=lambda _: -1e-9))
    with pytest.raises(ValueError, match="velvet on 17 nodes is not shown to create no energy"):
        fit(unproven, nodes=17)


def test_a_bounded_fit_that_is_not_proven_to_be_is_refused(monkeypatch):
    monkeypatch.setattr("fitting.fit.certify_range", lambda _: None)
    with pytest.raises(ValueError, match="not shown to be between 0 and 1"):
        fit(QUADRATIC_Q, Goal("linf", bounded=True))


def test_bounds_that_no_proof_is_known_for_are_refused_before_the_fit(monkeypatch):
    monkeypatch.setattr(exchange, "sample_of", None)
    with pytest.raises(ValueError, match="no proof is known that would bound rational-ps"):
        fit(RATIONAL_PS, Goal("linf", bounded=True))


def test_progress_is_told_of_every_stage():
    stages = []
    fit(QUADRATIC_Q, nodes=9, progress=stages.append)
    assert len(stages) == 3
    assert "Q" in stages[0]
    assert "Eq. (4)" in stages[1]
