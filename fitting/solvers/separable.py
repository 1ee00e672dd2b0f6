"""Fits of two-stage forms whose second stage is linear in the results of the first.

The first stage takes the axes that many points share; for P_s they are the material. At each node
of a grid of these axes, the best results m* of the first stage are found by linear least squares
over the points of the second stage; for P_s these are lights. The factor R of this problem's QR
decomposition gives the squared error of any other results m, summed over all these points:
|R (m − m*)|² + residual². This is exact, so that the sum is not computed again when the
coefficients of the first stage are then fitted to all nodes together.
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
    """The best m results of the first stage at every node, each node fitted by itself.

    * `optimum` (a, t, m): the best results at the nodes of the first axis (a) and the second (t).
    * `factors` (t, m, m): the factors R of the QR decompositions.
    * `residuals` (a, t): the mean square error of the best results.
    """

    optimum: Array
    factors: Array
    residuals: Array


@dataclass(frozen=True)
class Separable:
    """The solver of a two-stage form with two shared axes whose second stage is linear.

    * `shape`: the first stage.
    * `rule`: maps the name of a measure to points (n, …) of the axes that only the second stage
      takes, called inner points, and their weights (n,), which sum to one.
    * `exact`: maps the shared axes and the inputs of the second stage to the exact value.
    * `steps`: the most steps of the joint fit.
    * `nodes`: the joint fit uses about this many nodes an axis of a finer grid, because its time is
      proportional to their number and the surfaces are smooth. Errors are measured on all nodes.
    * `description`: the solver in words, for the table.

    The inputs of the second stage, and therefore the factors R, may depend on the second of the
    shared axes but not on the first.
    """

    shape: Quotients
    rule: Callable[[str], tuple[np.ndarray, np.ndarray]]
    exact: Callable[..., Array]
    steps: int = 100
    nodes: int = 17
    description: str = "QR per cell; Levenberg–Marquardt (optimistix) of all coefficients together"

    def fit(self, form: Form, count: int, measure: str, progress: Progress) -> GridFit:
        """Fit on `count` nodes an axis. `measure` names the weights of the inner points."""
        reference = form.reference
        grid = trapezoid_grid(form.axes[: form.shared], count)
        progress(f"exact {reference.symbol} and the best combination in every cell")
        fits = self.node_fits(form, grid, measure)
        progress(f"{form.size} coefficients of {form.printed or form.name} together")
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
        """Find the best results at every node of a grid of the shared axes, by QR."""
        inner, weights = self.rule(measure)
        exact = _exact_values(form, self.exact)(*grid.nodes, inner)
        found = _solve_nodes(form, self.count)(grid.nodes[1], inner, weights, exact)
        optimum, factors, residuals = found
        return NodeFits(jnp.swapaxes(optimum, 0, 1), factors, residuals.T)

    @property
    def count(self) -> int:
        """The number of results of the first stage."""
        assert isinstance(self.shape.offset, tuple)
        return len(self.shape.offset)

    def _jointly(self, grid: Grid, fits: NodeFits) -> Array:
        """Fit all coefficients together; `fits` hold the sums over the inner points."""
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
        """Return the largest error for results (a, t, m) of the first stage, and its point."""
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
    """Return the second stage's inputs at inner points (n, …), for a node of the second axis."""
    assert form.inputs is not None
    inputs = form.inputs
    # The inputs do not depend on the first axis (see Separable): any value of it will do.
    first = form.axes[0].lower
    return jax.vmap(lambda point: inputs(first, node, *point))(inner)


def _basis(form: Form, count: int, node, inner):
    """Return the factors (n, count) of the first stage's `count` results in the second stage."""
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


# Cached, so that its two callers share one compilation. In the loop of `lax.map` XLA keeps the
# values from which P_s is computed in vector registers, which is much faster than one large `vmap`.
@functools.lru_cache(maxsize=8)
def _exact_values(form: Form, exact: Callable[..., Array]):
    """Return a function that computes exact values (t, a, n).

    Its arguments are nodes (a,) and (t,) of the two shared axes and inner points (n, …).
    """

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
    """Keep every k-th node of each axis, both ends included, so that about `most` are left.

    k is the largest divisor of the number n of intervals that is at most ⌈n/(most − 1)⌉. If n is
    prime, all nodes are kept.
    """
    count = len(grid.nodes[0])
    stride = -(-(count - 1) // (most - 1))
    while (count - 1) % stride:
        stride -= 1
    some = slice(None, None, stride)
    kept = NodeFits(fits.optimum[some, some], fits.factors[some], fits.residuals[some, some])
    return trapezoid_grid(grid.axes, (count - 1) // stride + 1), kept
