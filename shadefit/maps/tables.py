"""The widening of filtered lobes from its coefficient table, as a function of NumPy arrays."""

import functools

import numpy as np

from coefficients.packaged import packaged_table

# The table of w₁(u₁, u₂): see docs/sggx-maps.md.
WIDENING = "best/sggx-filter-axes-24"


@functools.cache
def _program() -> tuple[list[list], str, list[float]]:
    table = packaged_table(WIDENING)
    assert table.expression is not None
    return (
        [list(step) for step in table.expression.steps],
        table.expression.value,
        list(np.ravel(table.coefficients)),
    )


def widening(along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Return w₁ for shares u₁ = `along` and u₂ = `across` in [0, 1], arrays of one shape.

    The table's expression has only the four basic operations.
    """
    steps, value, constants = _program()
    names = {f"c{k}": each for k, each in enumerate(constants)}
    known = {**names, "along": along, "across": across}
    operations = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide}
    for k, (operation, *operands) in enumerate(steps):
        found = [known[each] if isinstance(each, str) else each for each in operands]
        known[f"t{k}"] = operations[operation](*found)
    return known[value]
