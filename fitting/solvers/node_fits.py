"""Linear least squares at every node of a grid, each node by itself, for two-stage forms.

At each node of two shared axes, the best results m* of the first stage are found by QR over the
points of the second stage, called inner points. The factor R of this decomposition gives the
squared error of any other results m, summed over all inner points: |R (m − m*)|² + residual².

The nodes are taken in blocks of one size, so that the exact values, of which there are thousands
for each node, exist for one block at a time, and nothing is compiled twice.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form
from integrals.compilation import jit_for_few_calls

# The nodes of the first and of the second axis in a block.
BLOCK = 65, 17
# From this number of nodes on, errors are computed by code that is optimised in full. It takes a
# quarter of a second more to compile, and 6 ns less for each exact value of P_s.
MANY = 100_000


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
    """The errors of a form.

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
        for a, t, firsts, seconds in self._blocks():
            given = self.form, self.exact, self.count
            block = _solved(*given, firsts, seconds, self.inner, self.weights)
            optimum, factors, residuals = map(np.asarray, block)
            tall, wide = a.stop - a.start, t.stop - t.start
            found.optimum[a, t] = np.swapaxes(optimum[:wide, :tall], 0, 1)
            found.factors[t], found.residuals[a, t] = factors[:wide], residuals[:wide, :tall].T
        return found

    def errors(self, coefficients: np.ndarray | Array) -> NodeErrors:
        """Return the errors of the form with these coefficients."""
        squares = np.empty((len(self.firsts), len(self.seconds)))
        largest, where = -np.inf, np.empty(0)
        compared = _compared_often if squares.size >= MANY else _compared
        for a, t, firsts, seconds in self._blocks():
            given = self.form, self.exact
            block = compared(*given, firsts, seconds, self.inner, self.weights, coefficients)
            tall, wide = a.stop - a.start, t.stop - t.start
            square, size, index = (np.asarray(each)[:wide, :tall] for each in block)
            squares[a, t] = square.T
            column, row = np.unravel_index(np.argmax(size), size.shape)
            if size[column, row] > largest:
                largest, light = float(size[column, row]), self.inner[index[column, row]]
                where = np.array([self.firsts[a][row], self.seconds[t][column], *light], float)
        return NodeErrors(squares, largest, where)

    def _blocks(self) -> Iterator[tuple[slice, slice, np.ndarray, np.ndarray]]:
        """Yield the slices of both axes that a block covers, and its nodes of both axes.

        A block at the end of an axis is filled with copies of the last node.
        """
        height, width = BLOCK
        for left in range(0, len(self.seconds), width):
            t = slice(left, min(left + width, len(self.seconds)))
            for top in range(0, len(self.firsts), height):
                a = slice(top, min(top + height, len(self.firsts)))
                firsts = _filled(self.firsts[a], height)
                yield a, t, firsts, _filled(self.seconds[t], width)


def _inputs(form: Form, node: Array, inner: Array) -> tuple[Array, ...]:
    """Return the inputs of the second stage at inner points (n, …), for a node of the second axis.

    They do not depend on the first axis (see `Nodes`): any value of it will do.
    """
    inputs, first = form.inputs, form.axes[0].lower
    assert inputs is not None
    return jax.vmap(lambda point: inputs(first, node, *point))(inner)


# In the loop of `lax.map` XLA keeps the values from which P_s is computed in vector registers,
# which is much faster than one large `vmap`.
@jit_for_few_calls(static=(0, 1, 2))
def _solved(form: Form, exact: Callable[..., Array], count: int, firsts, seconds, inner, weights):
    """Return the best results (t, a, m), the factors (t, m, m) and the mean squares (t, a)."""
    root, second = jnp.sqrt(weights), form.stages[1].call

    def factors_of(*inputs):
        return jax.grad(lambda results: second(results, *inputs))(jnp.zeros(count))

    def at_node(node):
        inputs = _inputs(form, node, inner)
        lined, fixed = (0,) * len(inputs), (None,) * len(inputs)
        row = jax.vmap(lambda first, *each: exact(first, node, *each), (None, *lined))
        weighted = jax.vmap(row, (0, *fixed))(firsts, *inputs) * root
        q, r = jnp.linalg.qr(jax.vmap(factors_of)(*inputs) * root[:, None])
        projection = weighted @ q
        solved = jax.scipy.linalg.solve_triangular(r, projection.T).T
        return solved, r, jnp.sum((weighted - projection @ q.T) ** 2, axis=1)

    return jax.lax.map(at_node, seconds)


def _differences(
    form: Form, exact: Callable[..., Array], firsts, seconds, inner, weights, coefficients
):
    """Return mean square errors, largest errors and their inner points' numbers, (t, a) each."""
    second, numbers = form.stages[1].call, jnp.arange(len(inner))

    def at_node(node):
        inputs = _inputs(form, node, inner)
        rows = jax.vmap(lambda first: form.first(coefficients, first, node))(firsts)

        # One node of the first axis at a time, so that its values stay in the fastest cache.
        def at_first(given):
            first, row = given
            error = jax.vmap(lambda *each: second(row, *each) - exact(first, node, *each))(*inputs)
            size = jnp.abs(error)
            largest = jnp.max(size)
            # This is the first index; `argmax` takes longer.
            index = jnp.min(jnp.where(size >= largest, numbers, len(numbers) - 1))
            return jnp.sum(weights * error**2), largest, index

        return jax.lax.map(at_first, (firsts, rows))

    return jax.lax.map(at_node, seconds)


_compared = jit_for_few_calls(_differences, static=(0, 1))
_compared_often = jax.jit(_differences, static_argnums=(0, 1))


def _filled(nodes: np.ndarray, count: int) -> np.ndarray:
    """Repeat the last node until there are `count`."""
    return np.append(nodes, np.repeat(nodes[-1:], count - len(nodes)))
