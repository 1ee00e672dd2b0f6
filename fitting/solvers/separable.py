"""Fits of two-stage forms whose second stage is linear in the results of the first.

The first stage takes the axes that many points share; for P_s they are the material. At each node
of a grid of these axes, the best results m* of the first stage are found by linear least squares
over the points of the second stage; for P_s these are lights (fitting/solvers/node_fits.py). The
factor R of this problem's QR decomposition gives the squared error of any other results m, summed
over all these points: |R (m − m*)|² + residual². This is exact, so that the sum is not computed
again when the coefficients of the first stage are then fitted to all nodes together.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.errors import Errors
from fitting.form import Form
from fitting.points.grids import Grid, trapezoid_grid
from fitting.shapes.quotients import Quotients
from fitting.solvers.node_fits import NodeFits, Nodes
from fitting.solvers.on_grid import GridFit, Progress
from fitting.solvers.quotients import fit_quotients, penalty_points
from integrals.compilation import jit_for_few_calls


@dataclass(frozen=True)
class Separable:
    """The solver of a two-stage form with two shared axes whose second stage is linear.

    * `shape`: the first stage.
    * `rule`: maps the name of a measure to points (n, …) of the axes that only the second stage
      takes, called inner points, and their weights (n,), which sum to one.
    * `exact`: maps the shared axes and the inputs of the second stage to the exact value.
    * `steps`: the most steps of the joint fit.
    * `nodes`: the joint fit uses at most this many nodes an axis, because its time is proportional
      to their number and the surfaces are smooth. Errors are measured on all nodes of the grid.
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
        thin = trapezoid_grid(grid.axes, min(count, self.nodes))
        fits = self.node_fits(form, thin, measure)
        progress(f"{form.size} coefficients of {form.printed or form.name} together")
        coefficients = self._jointly(thin, fits)
        progress(f"errors on {count}×{count} nodes")
        nodes = self._nodes(form, grid, measure)
        errors = nodes.errors(coefficients)
        on_grid = Errors(
            rms=float(np.sqrt(np.average(errors.squares.ravel(), weights=grid.weights))),
            largest=errors.largest,
            where={axis.name: float(x) for axis, x in zip(form.axes, errors.where, strict=True)},
            points=len(grid.weights) * len(nodes.weights),
        )
        corner = np.array([[axis.lower for axis in form.axes]])
        error = float(reference.estimates(corner).error[0])
        inner = len(nodes.weights)
        return GridFit(coefficients, grid, on_grid, error, measure, inner, self.description)

    def node_fits(self, form: Form, grid: Grid, measure: str) -> NodeFits:
        """Find the best results at every node of a grid of the shared axes, by QR."""
        return self._nodes(form, grid, measure).best()

    def _nodes(self, form: Form, grid: Grid, measure: str) -> Nodes:
        assert isinstance(self.shape.offset, tuple)
        firsts, seconds = grid.nodes
        count = len(self.shape.offset)
        return Nodes(form, self.exact, count, firsts, seconds, *self.rule(measure))

    def _jointly(self, grid: Grid, fits: NodeFits) -> Array:
        """Fit all coefficients together; `fits` hold the sums over the inner points."""
        arguments = penalty_points(grid.axes), np.sqrt(grid.weights), fits.factors, fits.optimum
        return _fit_jointly(self.shape, self.steps, grid.points, *arguments)


@jit_for_few_calls(static=(0, 1))
def _fit_jointly(
    shape: Quotients,
    steps: int,
    points: Array,
    penalised: Array,
    root: Array,
    factors: Array,
    optimum: Array,
) -> Array:
    outer = root.reshape(*optimum.shape[:2], 1)

    def errors(values: Array) -> Array:
        apart = values.reshape(optimum.shape) - optimum
        return outer * jnp.einsum("tij,atj->ati", factors, apart)

    targets = optimum.reshape(-1, optimum.shape[2])
    return fit_quotients(shape, points, penalised, root, targets, errors, steps)
