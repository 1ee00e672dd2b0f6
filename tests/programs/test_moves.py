"""The moves of elements in NumPy against the primitives of JAX."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import lax

from programs.tracing.moves import MOVES

X = np.arange(24.0).reshape(2, 3, 4)
CASES = {
    "broadcast_in_dim": [
        (lambda x: lax.broadcast_in_dim(x, (5, 2, 1, 3, 4), (1, 3, 4)), [X]),
        (lambda x: lax.broadcast_in_dim(x, (2, 3), ()), [np.array(2.0)]),
        (lambda x: lax.broadcast_in_dim(x, (3, 4), (0, 1)), [X[0, :, :1]]),
    ],
    "concatenate": [(lambda x, y: lax.concatenate([x, y], 1), [X, X[:, :2]])],
    "dynamic_slice": [
        (lambda x, i, j, k: lax.dynamic_slice(x, (i, j, k), (1, 2, 2)), [X, *map(np.array, at)])
        for at in ((1, 0, 2), (9, -7, 3), (-1, 2, 1))
    ],
    "reshape": [(lambda x: lax.reshape(x, (4, 6)), [X])],
    "rev": [(lambda x: lax.rev(x, (0, 2)), [X])],
    "slice": [
        (lambda x: lax.slice(x, (0, 1, 0), (2, 3, 4), (1, 1, 3)), [X]),
        (lambda x: lax.slice(x, (1, 0, 2), (2, 3, 4)), [X]),
    ],
    "split": [(lambda x: lax.split(x, (1, 3), 2), [X])],
    "squeeze": [(lambda x: lax.squeeze(x, (0, 2)), [X[:1, :, :1]])],
    "stack": [(lambda x, y: jnp.stack([x, y], 1), [X, X + 1])],
    "transpose": [(lambda x: lax.transpose(x, (2, 0, 1)), [X])],
}


def test_every_move_has_a_case():
    assert set(CASES) == set(MOVES)


@pytest.mark.parametrize("name", MOVES)
def test_a_move_gives_what_jax_gives(name):
    for function, operands in CASES[name]:
        equations = jax.make_jaxpr(function)(*operands).jaxpr.eqns
        (equation,) = (each for each in equations if each.primitive.name == name)
        found = MOVES[name](operands, equation.params)
        wanted = jax.tree.leaves(equation.primitive.bind(*operands, **equation.params))
        assert len(found) == len(wanted)
        for one, other in zip(found, wanted, strict=True):
            np.testing.assert_array_equal(one, other)
            assert one.shape == other.shape


def test_a_move_takes_operands_of_a_program():
    names = np.array(["x", 1.5, "y"], dtype=object)
    moved = MOVES["rev"]([names], {"dimensions": (0,)})
    assert list(moved[0]) == ["y", 1.5, "x"]
