"""Fits that take the counterexamples of a search by bounds: a ridge that no point meets."""

import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Goal, form_values
from fitting.fit import fit
from fitting.form import FittedForm
from fitting.proofs import counterexamples as module
from fitting.proofs.counterexamples import counterexamples
from fitting.proofs.largest_error import ErrorCode, difference_code
from fitting.solvers.exchange import Exchange
from integrals import Axis, Estimate, Reference, Sampling
from programs.bounding.compiled import compiler_missing
from programs.toolchains.process import ToolchainError
from quantities import problem
from tests.fitting.toys import toy_form

needs_compiler = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

# The ridge at x = RIDGE is so narrow that random points miss it, and it has no slopes beside it.
RIDGE, WIDTH, HEIGHT, BENT = 0.31415926, 1e-5, 0.1, 0.02
AXES = (Axis("x", 0.0, 1.0, meaning="across"), Axis("y", 0.0, 1.0, meaning="along"))


def exact(x, y):
    """A plane that is bent a little, and a ridge along y that rises from HEIGHT/2 to HEIGHT."""
    roof = jnp.maximum(1 - jnp.abs(x - RIDGE) / WIDTH, 0.0)
    return jnp.asarray(1 + x + 0.3 * y + BENT * x * x + HEIGHT * (0.5 + 0.5 * y) * roof)


RIDGED = Reference(
    name="ridged",
    symbol="f",
    meaning="a plane with a narrow ridge",
    definition="1 + x + 0.3 y, and a ridge",
    axes=AXES,
    sampling=Sampling(fitted=7, checked=8, judged=8),
    closed_form=lambda x, y: Estimate(exact(x, y), jnp.full((), 1e-15)),
)
PLANE = toy_form(
    lambda c, x, y: jnp.asarray(c[0] + c[1] * x + c[2] * y),
    ["1", "x", "y"],
    name="plane-of-ridge",
    axes=AXES,
)
PLANE = type(PLANE)(**{**vars(PLANE), "reference": RIDGED})


def code(fitted: FittedForm) -> ErrorCode:
    return difference_code(fitted, exact, 1e-15)


def on_the_ridge(fitted: FittedForm) -> float:
    points = np.array([[RIDGE, 1.0]])
    return float(np.abs(form_values(fitted, points) - RIDGED.values(points))[0])


def test_without_the_search_the_ridge_is_missed():
    found = fit(PLANE, Goal("linf"))
    # A parabola is at most an eighth from a line.
    assert found.off_grid.largest == pytest.approx(BENT / 8, rel=1e-3)
    assert on_the_ridge(found.fitted) > 0.95 * HEIGHT


@needs_compiler
@pytest.mark.slow
def test_the_search_finds_the_ridge_and_the_fit_halves_the_error():
    exchange = Exchange(searches=3, above=2e-3)
    found = fit(PLANE, Goal("linf"), exchange=exchange, counterexamples=counterexamples(code))
    # The exact value jumps by HEIGHT within WIDTH, so that no plane has a smaller error than half.
    assert on_the_ridge(found.fitted) == pytest.approx(HEIGHT / 2, rel=2e-3)
    assert found.on_grid.largest == pytest.approx(HEIGHT / 2, rel=2e-3)
    assert found.converged
    assert np.any(np.abs(found.grid.points[:, 0] - RIDGE) < WIDTH)


@needs_compiler
def test_all_points_that_are_found_are_above_the_level():
    fitted = PLANE.fitted(np.array([1.0, 1.0, 0.3]))
    points = counterexamples(code)(fitted, 0.6 * HEIGHT)
    errors = np.abs(form_values(fitted, points) - RIDGED.values(points))
    assert len(points) > 1
    assert np.all(errors > 0.6 * HEIGHT) and errors.max() > 0.98 * HEIGHT


def test_the_search_is_asked_a_bounded_number_of_times():
    """Each answer is a new point, so that only the limit ends the fit, which says so."""
    asked = []

    def search(fitted, level):
        asked.append(level)
        return np.array([[0.1 * len(asked) % 1, 0.5]])

    exchange = Exchange(exchanges=2, searches=3)
    fit(PLANE, Goal("linf"), exchange=exchange, counterexamples=search)
    assert len(asked) == 3


@pytest.mark.parametrize("goal", [Goal(), Goal("linf", relative=True), Goal("linf", side="below")])
def test_other_goals_do_not_use_the_search(goal):
    def search(fitted, level):
        raise AssertionError("the level of the search is one of plain errors")

    fit(PLANE, goal, counterexamples=search)


def test_without_a_compiler_there_is_no_search(monkeypatch):
    monkeypatch.setattr(module, "compiler_missing", lambda: "gcc is not installed")
    assert counterexamples(code) is None
    assert problem("q").counterexamples() is None


@needs_compiler
def test_an_error_without_code_has_no_counterexamples():
    fitted = PLANE.fitted(np.zeros(3))

    def unknown(_):
        raise ValueError("an operation is not known")

    def broken(_):
        raise ToolchainError("gcc fails")

    for code_of_error in (lambda _: None, unknown, broken):
        assert counterexamples(code_of_error)(fitted, 0.0).shape == (0, 2)
