"""Functions as graphs of MaterialX's standard nodes, which every renderer of MaterialX has."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import frexp

import numpy as np

from programs.functions import Function
from programs.printing.lowering import lowered
from programs.program import Operand, is_value
from programs.tracing.tracer import trace


@dataclass(frozen=True)
class Argument:
    """An input of the whole graph."""

    name: str


@dataclass(frozen=True)
class Result:
    """What the node with this number gives."""

    node: int


# What an input of a node is connected to; a float is a constant
Source = Argument | Result | float


@dataclass(frozen=True)
class Node:
    """A standard node of MaterialX: its category, and its inputs, all of which are floats."""

    category: str
    inputs: tuple[tuple[str, Source], ...]


class _Graph:
    def __init__(self):
        self.nodes: list[Node] = []
        self.known: dict[Node, Result] = {}

    def add(self, category: str, names: str, *sources: Source) -> Result:
        """Add a node, unless there is the same one. `names` are those of its inputs."""
        given = tuple(zip(names.split(), map(self.held, sources), strict=True))
        node = Node(category, given)
        if node not in self.known:
            self.nodes.append(node)
            self.known[node] = Result(len(self.nodes) - 1)
        return self.known[node]

    def held(self, source: Source) -> Source:
        """Return a constant as a source that keeps all of its digits.

        MaterialX writes constants into shaders with six decimals. In [16, 32) these are enough for
        float32, so other constants are divided by a power of two.
        """
        if not isinstance(source, float):
            return source
        value = np.float32(source)
        if np.float32(f"{value:.6f}") == value:
            return float(value)
        scale = 2.0 ** (5 - frexp(float(value))[1])
        return self.add("divide", _TWO, float(value) * scale, scale)


_ONE, _TWO, _COMPARED = "in", "in1 in2", "value1 value2 in1 in2"
# Operation -> category of the node that computes it from the same operands, and its inputs
_NODES = {
    "add": ("add", _TWO),
    "sub": ("subtract", _TWO),
    "mul": ("multiply", _TWO),
    "div": ("divide", _TWO),
    "min": ("min", _TWO),
    "max": ("max", _TWO),
    "pow": ("power", _TWO),
    "atan2": ("atan2", "iny inx"),
    "abs": ("absval", _ONE),
    "log": ("ln", _ONE),
    **{name: (name, _ONE) for name in ("sqrt", "floor", "ceil", "exp")},
    **{name: (name, _ONE) for name in ("sin", "cos", "tan", "asin", "acos")},
    # Conditions are the numbers 0 and 1.
    "and": ("min", _TWO),
    "or": ("max", _TWO),
}
# Operation -> how it is composed of nodes
_COMPOSED: dict[str, Callable[..., Result]] = {
    "neg": lambda g, x: g.add("subtract", _TWO, 0.0, x),
    "rsqrt": lambda g, x: g.add("divide", _TWO, 1.0, g.add("sqrt", _ONE, x)),
    "exp2": lambda g, x: g.add("power", _TWO, 2.0, x),
    "atan": lambda g, x: g.add("atan2", "iny inx", x, 1.0),
    "gt": lambda g, x, y: g.add("ifgreater", _COMPARED, x, y, 1.0, 0.0),
    "lt": lambda g, x, y: g.add("ifgreater", _COMPARED, y, x, 1.0, 0.0),
    "ge": lambda g, x, y: g.add("ifgreatereq", _COMPARED, x, y, 1.0, 0.0),
    "le": lambda g, x, y: g.add("ifgreatereq", _COMPARED, y, x, 1.0, 0.0),
    "not": lambda g, x: g.add("subtract", _TWO, 1.0, x),
    "select": lambda g, which, x, y: g.add("ifgreater", _COMPARED, which, 0.5, x, y),
}
_KNOWN = (*_NODES, *_COMPOSED)


def node_graph(functions: Sequence[Function]) -> tuple[list[Node], Source]:
    """Return the nodes that compute a value, each after those that it uses, and the value's source.

    Arguments: `functions`, in the order of their calls: the results of each are the first inputs of
    the next, and its scalar parameters are arguments of the graph. Raises ValueError for an
    operation that MaterialX's nodes do not have.
    """
    graph = _Graph()
    results: list[Source] = []
    for function in functions:
        scalars = [each.name for each in function.parameters if each.size is None]
        program = lowered(trace(function), _KNOWN)
        values: list[Source] = [*results, *map(Argument, scalars)]

        def source(operand: Operand, values: list[Source] = values) -> Source:
            return values[operand] if is_value(operand) else float(operand)

        for step in program.steps:
            operands = [source(operand) for operand in step.operands]
            if step.operation in _NODES:
                values.append(graph.add(*_NODES[step.operation], *operands))
            elif step.operation in _COMPOSED:
                values.append(_COMPOSED[step.operation](graph, *operands))
            else:
                raise ValueError(
                    f"operation {step.operation!r} in {function.name} is no node of MaterialX; "
                    f"allowed: {', '.join(_KNOWN)}"
                )
        results = [source(output) for output in program.outputs]
    (value,) = results
    return graph.nodes, value
