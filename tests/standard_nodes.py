"""What the standard nodes of MaterialX compute, for tests."""

import operator

import numpy as np

from programs.printing.node_graph import Argument, Result

_TWO = ("in1", "in2")
_COMPARED = ("value1", "value2", "in1", "in2")
# Category -> function, and the names of its operands
MEANING = {
    "add": (operator.add, _TWO),
    "subtract": (operator.sub, _TWO),
    "multiply": (operator.mul, _TWO),
    "divide": (operator.truediv, _TWO),
    "min": (np.minimum, _TWO),
    "max": (np.maximum, _TWO),
    "power": (np.power, _TWO),
    "atan2": (np.arctan2, ("iny", "inx")),
    "absval": (np.abs, ("in",)),
    "ln": (np.log, ("in",)),
    "sqrt": (np.sqrt, ("in",)),
    "floor": (np.floor, ("in",)),
    "ceil": (np.ceil, ("in",)),
    "exp": (np.exp, ("in",)),
    "sin": (np.sin, ("in",)),
    "cos": (np.cos, ("in",)),
    "tan": (np.tan, ("in",)),
    "asin": (np.arcsin, ("in",)),
    "acos": (np.arccos, ("in",)),
    "ifgreater": (lambda a, b, yes, no: np.where(a > b, yes, no), _COMPARED),
    "ifgreatereq": (lambda a, b, yes, no: np.where(a >= b, yes, no), _COMPARED),
}


def evaluate_nodes(nodes, value, arguments):
    """Return the value of a graph at arguments, which are numbers or arrays by name."""
    done = []

    def fetch(source):
        if isinstance(source, Argument):
            return arguments[source.name]
        return done[source.node] if isinstance(source, Result) else source

    for node in nodes:
        call, names = MEANING[node.category]
        given = dict(node.inputs)
        assert sorted(given) == sorted(names)
        done.append(call(*(fetch(given[name]) for name in names)))
    return fetch(value)
