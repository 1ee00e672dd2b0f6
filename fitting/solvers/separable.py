"""Fits of two-stage forms whose second stage is linear in the results of the first.

For given values of the axes that the first stage takes (of P_s: one material), the error is linear
in the first stage's results: one linear least squares problem a node over the second stage's points
(of P_s: lights). Its QR factor R turns the error of any other results m into
|R (m − m*)|² + residual²: the sum over the second stage's points is exact, and never has to be
formed again. The coefficients of the first stage are then fitted together.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.errors import Errors
from fitting.form import Form
from fitting.points.grids import Grid, trapezoid_grid
from fitting.shapes.quotients import Quotients
from fitting.solvers.on_grid import GridFit, Progress
from fitting.solvers.quotients import fit_quotients, penalty_points


@dataclass(frozen=True)
class NodeFits:
    """The best results of the first stage at every node, by themselves.

    `optimum` (a, t, m): the results at node a of the first axis and t of the second; `factors`
    (t, m, m): the QR factors; `residuals` (a, t): the mean square errors that are left.
    """

    optimum: Array
    factors: Array
    residuals: Array


@dataclass(frozen=True)
class Separable:
    """Solver of a two-stage form of two shared axes, whose second stage is linear.

    `shape` is the first stage. `rule` maps a measure's name to points (n, …) of the second stage's
    own axes and weights (n,) that sum to one. `exact` maps the shared axes and the second stage's
    inputs to the exact value. The second stage's inputs, and so the factors, may depend on the
    second of the shared axes, but not on the first.

    The joint fit ends after `steps`. It skips nodes of a grid that has more than `nodes` an axis:
    the surfaces are smooth, and the time goes with the nodes. Errors are measured on all of them.
    """

    shape: Quotients
    rule: Callable[[str], tuple[np.ndarray, np.ndarray]]
    exact: Callable[..., Array]
    steps: int = 100
    nodes: int = 17
    description: str = "QR per cell; Levenberg–Marquardt (optimistix) of all coefficients together"

    def fit(self, form: Form, count: int, measure: str, progress: Progress) -> GridFit:
        """Fit on `count` nodes an axis; `measure` names the weights of the inner points."""
        reference = form.reference
        grid = trapezoid_grid(form.axes[: form.shared], count)
        progress(f"exact {reference.symbol} and the best combination in every cell")
        fits = self.node_fits(form, grid, measure)
        progress(f"{form.size} coefficients of {form.equation} together")
        coefficients = self._jointly(grid, fits)
        progress("errors and certificate")
        fitted = form.fitted(coefficients)
        points = jnp.asarray(grid.points)
        first = jax.jit(jax.vmap(fitted.first))(points[:, 0], points[:, 1])
        first = first.reshape(fits.optimum.shape)
        deviation = jnp.einsum("tij,atj->ati", fits.factors, first - fits.optimum)
        square = jnp.sum(deviation**2, axis=2) + fits.residuals
        largest, place = self._largest_error(form, grid, measure, first)
        inner = len(self.rule(measure)[1])
        on_grid = Errors(
            rms=float(jnp.sqrt(jnp.average(square.ravel(), weights=grid.weights))),
            largest=largest,
            where={axis.name: float(x) for axis, x in zip(form.axes, place, strict=True)},
            points=len(grid.weights) * inner,
        )
        corner = np.array([[axis.lower for axis in form.axes]])
        error = float(reference.estimates(corner).error[0])
        return GridFit(coefficients, grid, on_grid, error, measure, inner, self.description)

    def node_fits(self, form: Form, grid: Grid, measure: str) -> NodeFits:
        """Solve every node of a grid of the shared axes by QR over weighted inner points."""
        inner, weights = self.rule(measure)
        exact = _exact_values(form, self.exact)(*grid.nodes, inner)
        found = _solve_nodes(form, self.count)(grid.nodes[1], inner, weights, exact)
        optimum, factors, residuals = found
        return NodeFits(jnp.swapaxes(optimum, 0, 1), factors, residuals.T)

    @property
    def count(self) -> int:
        """How many results the first stage has."""
        assert isinstance(self.shape.offset, tuple)
        return len(self.shape.offset)

    def _jointly(self, grid: Grid, fits: NodeFits) -> Array:
        """Fit all coefficients together, on the sum over the inner points, which `fits` hold."""
        grid, fits = _thinned(grid, fits, self.nodes)
        root = np.sqrt(grid.weights)
        shape = fits.optimum.shape

        outer = jnp.asarray(root.reshape(*shape[:2], 1))

        @jax.jit
        def fit(points: Array, penalised: Array, factors: Array, optimum: Array) -> Array:
            def errors(values: Array) -> Array:
                apart = values.reshape(shape) - optimum
                return outer * jnp.einsum("tij,atj->ati", factors, apart)

            targets = optimum.reshape(-1, shape[2])
            return fit_quotients(self.shape, points, penalised, root, targets, errors, self.steps)

        return fit(grid.points, penalty_points(grid.axes), fits.factors, fits.optimum)

    def _largest_error(
        self, form: Form, grid: Grid, measure: str, first: Array
    ) -> tuple[float, np.ndarray]:
        """Return the largest error of the first stage's results (a, t, m), and the point."""
        firsts, seconds = grid.nodes
        inner, _ = self.rule(measure)
        exact = _exact_values(form, self.exact)(firsts, seconds, inner)
        search = _search_nodes(form, self.count)
        largest, index = search(seconds, inner, exact, jnp.swapaxes(first, 0, 1))
        worst = int(np.argmax(largest))
        row, column = np.unravel_index(int(index[worst]), (len(firsts), len(inner)))
        place = np.array([firsts[row], seconds[worst], *inner[column]], dtype=float)
        return float(largest[worst]), place


def _inputs_of(form: Form, node, inner):
    """Evaluate the second stage's inputs at inner points (n, …) for a node of the second axis."""
    assert form.inputs is not None
    inputs = form.inputs
    # The first axis does not matter.
    first = form.axes[0].lower
    return jax.vmap(lambda point: inputs(first, node, *point))(inner)


def _basis(form: Form, count: int, node, inner):
    """Evaluate what multiplies each of the first stage's `count` results: (n, count)."""
    second = form.stages[1].call

    def row(*inputs):
        return jax.grad(lambda results: second(results, *inputs))(jnp.zeros(count))

    return jax.vmap(row)(*_inputs_of(form, node, inner))


@functools.lru_cache(maxsize=8)
def _solve_nodes(form: Form, count: int):
    @jax.jit
    def solve(nodes, inner, weights, exact):
        root = jnp.sqrt(weights)

        def at_node(inputs):
            node, values = inputs
            q, r = jnp.linalg.qr(_basis(form, count, node, inner) * root[:, None])
            projection = values * root @ q
            solved = jax.scipy.linalg.solve_triangular(r, projection.T).T
            return solved, r, jnp.sum((values * root - projection @ q.T) ** 2, axis=1)

        return jax.lax.map(at_node, (nodes, exact))

    return solve


@functools.lru_cache(maxsize=8)
def _search_nodes(form: Form, count: int):
    @jax.jit
    def search(nodes, inner, exact, results):
        def at_node(inputs):
            node, values, rows = inputs
            error = jnp.abs(rows @ _basis(form, count, node, inner).T - values).ravel()
            return jnp.max(error), jnp.argmax(error)

        return jax.lax.map(at_node, (nodes, exact, results))

    return search


# Compiled once for both of its callers. Within a loop XLA keeps the root in vector registers.
@functools.lru_cache(maxsize=8)
def _exact_values(form: Form, exact: Callable[..., Array]):
    """Return a function that gives the exact values (t, a, n) at nodes t, a and inner points n."""

    @jax.jit
    def values(firsts, seconds, inner):
        def at_node(node):
            inputs = _inputs_of(form, node, inner)
            lined, fixed = (0,) * len(inputs), (None,) * len(inputs)
            row = jax.vmap(lambda first, *each: exact(first, node, *each), (None, *lined))
            return jax.vmap(row, (0, *fixed))(firsts, *inputs)

        return jax.lax.map(at_node, seconds)

    return values


def _thinned(grid: Grid, fits: NodeFits, most: int) -> tuple[Grid, NodeFits]:
    """Keep every k-th node so that at most about `most` an axis are left, both ends among them."""
    count = len(grid.nodes[0])
    stride = -(-(count - 1) // (most - 1))
    while (count - 1) % stride:
        stride -= 1
    some = slice(None, None, stride)
    kept = NodeFits(fits.optimum[some, some], fits.factors[some], fits.residuals[some, some])
    return trapezoid_grid(grid.axes, (count - 1) // stride + 1), kept
