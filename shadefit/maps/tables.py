"""The widening of filtered lobes from its coefficient table, as a function of NumPy arrays."""

import numpy as np

from coefficients.packaged import packaged_table

# The table of w₁(u₁, u₂): see docs/sggx-maps.md.
WIDENING = "best/sggx-filter-axes-24"


_OPERATIONS = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide}


def widening(along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Return w₁ for shares u₁ = `along` and u₂ = `across` in [0, 1], arrays of one shape.

    The table's expression has only the four basic operations.
    """
    table = packaged_table(WIDENING)
    constants = enumerate(np.ravel(np.asarray(table.coefficients, float)))
    known: dict[str, np.ndarray] = {f"c{k}": np.asarray(each) for k, each in constants}
    known |= {"along": along, "across": across}
    assert table.expression is not None
    for k, step in enumerate(table.expression.steps):
        operation, *operands = (each for each in step)
        first, second = (
            known[each] if isinstance(each, str) else np.asarray(each, float) for each in operands
        )
        known[f"t{k}"] = _OPERATIONS[str(operation)](first, second)
    return known[str(table.expression.value)]
