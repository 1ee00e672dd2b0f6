"""P_s by its two stages: the best results of the first at every node, and all of them together."""

import functools
from dataclasses import replace

import jax
import numpy as np
import pytest

from fitting import form_values
from fitting.points.grids import Grid, trapezoid_grid
from fitting.solvers import node_fits, separable
from fitting.solvers.separable import Separable
from integrals import PS
from integrals.fuzz.ps import MEASURES
from quantities.fuzz.lights import light_directions
from quantities.fuzz.supplement import LIGHTS_PER_ANGLE, PS_ROWS, RATIONAL_PS
from tests.fitting.minima import replace_solver, worst_of

GRID = trapezoid_grid(RATIONAL_PS.axes[:2], 9)
COUNT = 12
THETA_U = RATIONAL_PS.axes[2]


def solver(count: int):
    """Return the solver of P_s with count² lights a material."""
    return replace(RATIONAL_PS.solver, rule=lambda measure: light_directions(count, measure))


@functools.cache
def fits(measure: str = "uniform"):
    return solver(COUNT).node_fits(RATIONAL_PS, GRID, measure)


@functools.cache
def problem(measure: str, row: int, column: int):
    """Return one node's matrix of Eq. (1)'s functions, exact P_s and weights, all by NumPy."""
    alpha, theta_f = GRID.nodes[0][row], GRID.nodes[1][column]
    lights, weights = light_directions(COUNT, measure)
    theta, phi = lights.T
    un = np.cos(theta)
    ut = np.sin(theta) * np.cos(phi) * np.sin(theta_f) + un * np.cos(theta_f)
    matrix = np.stack([np.ones_like(un), un, ut, un * un, un * ut, ut * ut], axis=1)
    material = np.broadcast_to([alpha, theta_f], lights.shape)
    return matrix, PS.values(np.concatenate([material, lights], axis=1)), weights


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("node", [(0, 0), (3, 5), (0, 8)])
def test_a_node_has_the_results_and_the_residual_that_numpy_finds(measure, node):
    matrix, exact, weights = problem(measure, *node)
    root = np.sqrt(weights)
    expected, residual, _, _ = np.linalg.lstsq(matrix * root[:, None], exact * root, rcond=None)
    np.testing.assert_allclose(fits(measure).optimum[node], expected, atol=1e-10)
    # P_s is evaluated from angles here, from cosines there.
    assert fits(measure).residuals[node] == pytest.approx(residual[0], rel=1e-9)


def test_measures_change_the_optimum():
    uniform = fits("uniform").optimum
    others = [measure for measure in MEASURES if measure != "uniform"]
    assert all(np.abs(fits(each).optimum - uniform).max() > 0.01 for each in others)


@pytest.mark.parametrize("node", [(0, 0), (3, 5)])
def test_factors_give_the_error_of_any_other_results_exactly(node):
    matrix, exact, weights = problem("uniform", *node)
    other = np.random.default_rng(0).normal(size=6)
    direct = weights @ (matrix @ other - exact) ** 2
    apart = fits().factors[node[1]] @ (other - fits().optimum[node])
    assert apart @ apart + fits().residuals[node] == pytest.approx(direct, rel=1e-12)


def test_without_anisotropy_the_constant_one_half_is_found():
    expected = np.broadcast_to([0.5, 0, 0, 0, 0, 0], (9, 6))
    np.testing.assert_allclose(fits().optimum[-1], expected, atol=1e-12)
    np.testing.assert_allclose(fits().residuals[-1], 0, atol=1e-28)


def test_a_fibre_in_the_surface_has_no_terms_that_are_odd_along_it():
    np.testing.assert_allclose(fits().optimum[:, -1, [2, 4]], 0, atol=1e-12)
    assert np.abs(fits().optimum[:-1, :-1, [2, 4]]).min() > 1e-3


@pytest.mark.slow
def test_more_lights_change_the_best_rms_by_less_than_one_in_a_million():
    grid = trapezoid_grid(RATIONAL_PS.axes[:2], 5)
    rms = [
        np.sqrt(grid.weights @ np.ravel(each.node_fits(RATIONAL_PS, grid, "uniform").residuals))
        for each in (RATIONAL_PS.solver, solver(96))
    ]
    assert LIGHTS_PER_ANGLE**2 >= 2000
    assert len(RATIONAL_PS.solver.rule("uniform")[1]) == LIGHTS_PER_ANGLE**2
    assert abs(rms[1] - rms[0]) < 1e-6
    # The rms itself is four orders larger.
    assert rms[0] > 0.01


def test_the_limit_of_eq_1_is_the_measured_one():
    # 32 × 33 materials of α in [0.15, 1) and θf in [0.1, π/2], all of the same weight.
    alphas = np.linspace(0.15, 1, 33)[:-1]
    thetas = np.linspace(0.1, np.pi / 2, 33)
    weights = np.full(32 * 33, 1 / (32 * 33))
    grid = Grid(RATIONAL_PS.axes[:2], (alphas, thetas), weights, "uniform")
    rms = np.sqrt(np.mean(solver(24).node_fits(RATIONAL_PS, grid, "uniform").residuals))
    assert rms == pytest.approx(0.0113, abs=5e-5)


# All coefficients together


@functools.cache
def together():
    stages = []
    return solver(COUNT).fit(RATIONAL_PS, 9, "solid-angle", stages.append), stages


@pytest.mark.slow
def test_a_fit_states_the_errors_at_every_node_and_light():
    found, _ = together()
    fitted = RATIONAL_PS.fitted(found.coefficients)
    lights, weights = light_directions(COUNT, "solid-angle")
    square, largest, place = 0.0, 0.0, None
    for material, share in zip(GRID.points, GRID.weights, strict=True):
        points = np.concatenate([np.broadcast_to(material, lights.shape), lights], axis=1)
        error = np.abs(form_values(fitted, points) - PS.values(points))
        square += share * (weights @ error**2)
        if error.max() > largest:
            largest, place = error.max(), points[error.argmax()]
    assert found.on_grid.rms == pytest.approx(np.sqrt(square), rel=1e-9)
    assert found.on_grid.largest == pytest.approx(largest, rel=1e-9)
    assert place is not None
    np.testing.assert_allclose(list(found.on_grid.where.values()), place, rtol=1e-15)
    assert list(found.on_grid.where) == ["alpha", "theta_f", "theta_u", "phi"]
    assert found.on_grid.points == 81 * COUNT**2


@pytest.mark.slow
def test_a_fit_says_how_it_was_made():
    found, stages = together()
    assert (found.measure, found.inner) == ("solid-angle", COUNT**2)
    assert "QR per cell" in found.solver
    assert 0 < found.reference_error < 1e-12
    assert len(stages) == 3
    assert "P_s" in stages[0]
    assert "162 coefficients of Eq. (1) and (2)" in stages[1]


MATERIALS = trapezoid_grid(RATIONAL_PS.axes[:2], 13)
TOGETHER = solver(16)


@functools.cache
def materials():
    return TOGETHER.node_fits(RATIONAL_PS, MATERIALS, "uniform")


def limit() -> float:
    return float(np.sqrt(MATERIALS.weights @ np.ravel(materials().residuals)))


def rms() -> float:
    """Return the rms of a new fit of all coefficients, through its first stage at every node."""
    rows = TOGETHER._jointly(MATERIALS, materials())
    results = jax.jit(jax.vmap(lambda a, t: PS_ROWS(rows, a, t)))(*MATERIALS.points.T)
    apart = results.reshape(13, 13, 6) - materials().optimum
    error = np.einsum("tij,atj->ati", materials().factors, apart)
    square = np.sum(error**2, axis=2) + materials().residuals
    return float(np.sqrt(MATERIALS.weights @ np.ravel(square)))


@pytest.mark.slow
def test_all_together_come_close_to_the_best_of_every_node_and_polynomials_do_not(monkeypatch):
    assert limit() < rms() < 1.002 * limit()
    replace_solver(
        monkeypatch, separable, lambda residual, start, steps: start, "_fit_jointly", (0, 1)
    )
    assert rms() > 1.01 * limit()


@pytest.mark.slow
def test_the_worst_of_several_starts_comes_as_close(monkeypatch):
    replace_solver(monkeypatch, separable, worst_of(4, 0.1), "_fit_jointly", (0, 1))
    assert rms() < 1.002 * limit()


@pytest.mark.parametrize(("count", "kept"), [(9, 9), (17, 17), (34, 17), (1025, 17)])
def test_a_joint_fit_uses_few_nodes_of_a_fine_grid(monkeypatch, count, kept):
    grids = []

    def seen(self, form, grid, measure):
        grids.append(grid)
        raise StopIteration

    monkeypatch.setattr(Separable, "node_fits", seen)
    with pytest.raises(StopIteration):
        solver(COUNT).fit(RATIONAL_PS, count, "uniform", lambda _: None)
    assert [len(nodes) for nodes in grids[0].nodes] == [kept, kept]
    assert grids[0].axes == RATIONAL_PS.axes[:2]


def test_a_grid_of_several_blocks_gives_what_its_nodes_give_alone(monkeypatch):
    whole = fits()
    results = np.random.default_rng(3).normal(size=whole.optimum.shape)
    nodes = solver(COUNT)._nodes(RATIONAL_PS, GRID, "uniform")
    errors = nodes.errors(results)
    monkeypatch.setattr(node_fits, "BLOCK", (5, 4))
    blocks, other = nodes.best(), nodes.errors(results)
    np.testing.assert_allclose(blocks.optimum, whole.optimum, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(blocks.factors, whole.factors, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(other.squares, errors.squares, rtol=1e-12)
    assert other.largest == pytest.approx(errors.largest, rel=1e-12)
    np.testing.assert_array_equal(other.where, errors.where)
