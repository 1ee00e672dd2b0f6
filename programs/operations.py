"""The operations of a straight-line program. Exported code uses no others."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Operation:
    """One operation: the number of its operands, its meaning, and the kind it is counted as.

    `numpy` computes it element by element and rounds the result to the type of the operands. `kind`
    is a key of `programs.cost.WEIGHTS`. `gives` is the type of the result, "real" or "bool". If the
    operation is `commutative`, exchanging its operands changes no bit of the result.
    """

    arity: int
    numpy: Callable[..., Any]
    kind: str
    gives: str = "real"
    commutative: bool = False


def _reciprocal_root(x):
    return np.asarray(1, x.dtype) / np.sqrt(x)


OPERATIONS: dict[str, Operation] = {
    "add": Operation(2, np.add, "add", commutative=True),
    "sub": Operation(2, np.subtract, "add"),
    "mul": Operation(2, np.multiply, "mul", commutative=True),
    "div": Operation(2, np.divide, "div"),
    "neg": Operation(1, np.negative, "sign"),
    "abs": Operation(1, np.abs, "sign"),
    "sqrt": Operation(1, np.sqrt, "sqrt"),
    "rsqrt": Operation(1, _reciprocal_root, "sqrt"),
    "min": Operation(2, np.minimum, "select", commutative=True),
    "max": Operation(2, np.maximum, "select", commutative=True),
    "floor": Operation(1, np.floor, "select"),
    "ceil": Operation(1, np.ceil, "select"),
    "lt": Operation(2, np.less, "select", gives="bool"),
    "le": Operation(2, np.less_equal, "select", gives="bool"),
    "gt": Operation(2, np.greater, "select", gives="bool"),
    "ge": Operation(2, np.greater_equal, "select", gives="bool"),
    "eq": Operation(2, np.equal, "select", gives="bool", commutative=True),
    "ne": Operation(2, np.not_equal, "select", gives="bool", commutative=True),
    "and": Operation(2, np.logical_and, "select", gives="bool", commutative=True),
    "or": Operation(2, np.logical_or, "select", gives="bool", commutative=True),
    "not": Operation(1, np.logical_not, "select", gives="bool"),
    # select(condition, value if true, value if false)
    "select": Operation(3, np.where, "select"),
    "exp": Operation(1, np.exp, "transcendental"),
    "exp2": Operation(1, np.exp2, "transcendental"),
    "expm1": Operation(1, np.expm1, "transcendental"),
    "log": Operation(1, np.log, "transcendental"),
    "log1p": Operation(1, np.log1p, "transcendental"),
    "pow": Operation(2, np.power, "transcendental"),
    "sin": Operation(1, np.sin, "transcendental"),
    "cos": Operation(1, np.cos, "transcendental"),
    "tan": Operation(1, np.tan, "transcendental"),
    "asin": Operation(1, np.arcsin, "transcendental"),
    "acos": Operation(1, np.arccos, "transcendental"),
    "atan": Operation(1, np.arctan, "transcendental"),
    "atan2": Operation(2, np.arctan2, "transcendental"),
    "sinh": Operation(1, np.sinh, "transcendental"),
    "cosh": Operation(1, np.cosh, "transcendental"),
    "tanh": Operation(1, np.tanh, "transcendental"),
}
