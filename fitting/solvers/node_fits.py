"""Linear least squares at every node of a grid, each node by itself, for two-stage forms.

At each node of two shared axes, the best results m* of the first stage are found by QR over the
points of the second stage, called inner points. The factor R of this decomposition gives the
squared error of any other results m, summed over all inner points: |R (m − m*)|² + residual².

The nodes are taken in blocks of one size, so that the exact values, of which there are thousands
for each node, exist for one block at a time. One compiled function does all that is asked of a
block, because compiling takes longer than running it.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form
from integrals.compilation import jit_for_few_calls

# The nodes of the first and of the second axis in a block.
BLOCK = 65, 17


@dataclass(frozen=True)
class NodeFits:
    """The best m results of the first stage at every node, each node fitted by itself.

    * `optimum` (a, t, m): the best results at the nodes of the first axis (a) and the second (t).
    * `factors` (t, m, m): the factors R of the QR decompositions.
    * `residuals` (a, t): the mean square error of the best results.
    """

    optimum: np.ndarray
    factors: np.ndarray
    residuals: np.ndarray


@dataclass(frozen=True)
class NodeErrors:
    """The errors of given results of the first stage.

    `squares` (a, t) has the mean square error at every node. `largest` is the largest absolute
    error, and `where` its point, with a value for each axis of the form.
    """

    squares: np.ndarray
    largest: float
    where: np.ndarray


@dataclass(frozen=True)
class Nodes:
    """Nodes of two shared axes, with the inner points at each.

    * `exact`: maps the shared axes and the inputs of the second stage to the exact value.
    * `count`: the number m of results of the first stage.
    * `firsts` (a,), `seconds` (t,): the nodes of the two axes.
    * `inner` (n, …): the inner points. `weights` (n,) sum to one.

    The inputs of the second stage, and therefore the factors R, may depend on the second of the
    shared axes but not on the first.
    """

    form: Form
    exact: Callable[..., Array]
    count: int
    firsts: np.ndarray
    seconds: np.ndarray
    inner: np.ndarray
    weights: np.ndarray

    def best(self) -> NodeFits:
        """Find the best results at every node."""
        shape = len(self.firsts), len(self.seconds)
        found = NodeFits(
            np.empty((*shape, self.count)),
            np.empty((shape[1], self.count, self.count)),
            np.empty(shape),
        )
        for a, t, block in self._blocks(np.zeros((*shape, self.count))):
            found.optimum[a, t] = np.swapaxes(block.optimum, 0, 1)
            found.factors[t], found.residuals[a, t] = block.factors, block.residuals.T
        return found

    def errors(self, results: np.ndarray) -> NodeErrors:
        """Return the errors of results (a, t, m) of the first stage."""
        squares = np.empty(results.shape[:2])
        largest, where = -np.inf, np.empty(0)
        for a, t, block in self._blocks(results):
            squares[a, t] = block.squares.T
            worst = int(np.argmax(block.largest))
            if block.largest[worst] > largest:
                row, column = np.unravel_index(block.index[worst], (BLOCK[0], len(self.inner)))
                place = (self.firsts[a][row], self.seconds[t][worst], *self.inner[column])
                largest, where = float(block.largest[worst]), np.array(place, float)
        return NodeErrors(squares, largest, where)

    def _blocks(self, results: np.ndarray) -> Iterator[tuple[slice, slice, "_Block"]]:
        """Yield the slices of both axes that a block covers, and what is known of the block.

        A block at the end of an axis is filled with copies of the last node, which are cut off.
        """
        height, width = BLOCK
        for left in range(0, len(self.seconds), width):
            t = slice(left, min(left + width, len(self.seconds)))
            for top in range(0, len(self.firsts), height):
                a = slice(top, min(top + height, len(self.firsts)))
                firsts = _filled(self.firsts[a], 0, height)
                seconds = _filled(self.seconds[t], 0, width)
                rows = np.swapaxes(results[a, t], 0, 1)
                rows = _filled(_filled(rows, 0, width), 1, height)
                block = _solved(
                    *(self.form, self.exact, self.count),
                    *(firsts, seconds, self.inner, self.weights, rows),
                )
                tall, wide = a.stop - a.start, t.stop - t.start
                optimum, factors, residuals, squares, largest, index = map(np.asarray, block)
                yield (
                    *(a, t),
                    _Block(
                        *(optimum[:wide, :tall], factors[:wide]),
                        *(residuals[:wide, :tall], squares[:wide, :tall]),
                        *(largest[:wide], index[:wide]),
                    ),
                )


class _Block(NamedTuple):
    """What is known of t nodes of the second axis, each with a nodes of the first.

    `optimum` (t, a, m), `factors` (t, m, m), `residuals` (t, a) are those of `NodeFits`. Of the
    given results, `squares` (t, a) are the mean square errors, `largest` (t,) the largest error at
    each node of the second axis, and `index` (t,) its place among the values (a, n) there.
    """

    optimum: np.ndarray
    factors: np.ndarray
    residuals: np.ndarray
    squares: np.ndarray
    largest: np.ndarray
    index: np.ndarray


# In the loop of `lax.map` XLA keeps the values from which P_s is computed in vector registers,
# which is much faster than one large `vmap`.
@jit_for_few_calls(static=(0, 1, 2))
def _solved(
    form: Form, exact: Callable[..., Array], count: int, firsts, seconds, inner, weights, rows
):
    root = jnp.sqrt(weights)
    second, inputs_of = form.stages[1].call, form.inputs
    assert inputs_of is not None
    # The inputs do not depend on the first axis (see `Nodes`): any value of it will do.
    any_first = form.axes[0].lower

    def factors_of(*inputs):
        return jax.grad(lambda results: second(results, *inputs))(jnp.zeros(count))

    def at_node(given):
        node, results = given
        inputs = jax.vmap(lambda point: inputs_of(any_first, node, *point))(inner)
        lined, fixed = (0,) * len(inputs), (None,) * len(inputs)
        row = jax.vmap(lambda first, *each: exact(first, node, *each), (None, *lined))
        values = jax.vmap(row, (0, *fixed))(firsts, *inputs)
        basis = jax.vmap(factors_of)(*inputs)
        q, r = jnp.linalg.qr(basis * root[:, None])
        weighted = values * root
        projection = weighted @ q
        solved = jax.scipy.linalg.solve_triangular(r, projection.T).T
        residual = jnp.sum((weighted - projection @ q.T) ** 2, axis=1)
        square = jnp.sum(((results - solved) @ r.T) ** 2, axis=1) + residual
        error = jnp.abs(results @ basis.T - values).ravel()
        index = jnp.argmax(error)
        return solved, r, residual, square, error[index], index

    return jax.lax.map(at_node, (seconds, rows))


def _filled(values: np.ndarray, axis: int, count: int) -> np.ndarray:
    """Repeat the last element along an axis until there are `count`."""
    missing = count - values.shape[axis]
    return np.concatenate([values, np.repeat(values.take([-1], axis), missing, axis)], axis)
