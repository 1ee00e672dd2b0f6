"""Translating the primitives of a jaxpr, on small arrays, into steps of a straight-line program."""

from collections.abc import Callable
from functools import partial, reduce
from typing import Any

import numpy as np
from jax.extend.core import JaxprEqn

from programs.operations import OPERATIONS
from programs.program import Operand
from programs.tracing.builder import Builder
from programs.tracing.moves import MOVES

# Primitives that call another jaxpr -> the parameter that holds that jaxpr
CALLS = {
    "jit": "jaxpr",
    "pjit": "jaxpr",
    "closed_call": "call_jaxpr",
    "core_call": "call_jaxpr",
    "custom_jvp_call": "call_jaxpr",
    "custom_vjp_call": "call_jaxpr",
    "custom_vjp_call_jaxpr": "fun_jaxpr",
    "checkpoint": "jaxpr",
    "remat2": "jaxpr",
}


def _square(builder: Builder, x: Operand) -> Operand:
    return builder.apply("mul", x, x)


def _power(builder: Builder, x: Operand, y: int) -> Operand:
    if y < 0:
        return builder.apply("div", 1.0, _power(builder, x, -y))
    if y == 0:
        return 1.0
    if y == 1:
        return x
    # x³ = x²·x and x⁴ = x²·x²: other powers of x share the lower powers.
    half = _power(builder, x, y // 2) if y % 2 == 0 else _power(builder, x, y - 1)
    return builder.apply("mul", half, half if y % 2 == 0 else x)


def _logistic(builder: Builder, x: Operand) -> Operand:
    exponential = builder.apply("exp", builder.apply("neg", x))
    return builder.apply("div", 1.0, builder.apply("add", 1.0, exponential))


def _sign(builder: Builder, x: Operand) -> Operand:
    negative = builder.apply("select", builder.apply("lt", x, 0.0), -1.0, 0.0)
    return builder.apply("select", builder.apply("gt", x, 0.0), 1.0, negative)


def _clamp(builder: Builder, low: Operand, x: Operand, high: Operand) -> Operand:
    return builder.apply("min", builder.apply("max", x, low), high)


def _select(builder: Builder, which: Operand, *cases: Operand) -> Operand:
    if len(cases) != 2:
        raise ValueError(f"a selection among {len(cases)} cases; allowed: 2")
    return builder.apply("select", which, cases[1], cases[0])


def _direct(name: str) -> Callable[..., Operand]:
    return lambda builder, *operands: builder.apply(name, *operands)


ELEMENTWISE: dict[str, Callable[..., Operand]] = {
    # Most operations of a program have the same name as the primitive of JAX.
    **{name: _direct(name) for name in OPERATIONS if name != "select"},
    "clamp": _clamp,
    "copy": lambda builder, x: x,
    "logistic": _logistic,
    "name": lambda builder, x: x,
    "select_n": _select,
    "sign": _sign,
    "square": _square,
}

_REDUCTIONS = {
    "reduce_sum": "add",
    "reduce_prod": "mul",
    "reduce_max": "max",
    "reduce_min": "min",
    "reduce_and": "and",
    "reduce_or": "or",
}

# Primitives that only move elements -> positions of the operands that hold the elements; () means
# all operands. The other operands are indices, which must be constants.
_MOVED_OPERANDS: dict[str, tuple[int, ...]] = {
    "broadcast_in_dim": (),
    "concatenate": (),
    "dynamic_slice": (0,),
    "dynamic_update_slice": (0, 1),
    "expand_dims": (),
    "gather": (0,),
    "pad": (),
    "reshape": (),
    "rev": (),
    "scatter": (0, 2),
    "slice": (),
    "split": (),
    "squeeze": (),
    "stack": (),
    "transpose": (),
}


def writable_primitives() -> str:
    """List the primitives that can be translated, for error messages."""
    names = {*ELEMENTWISE, *_REDUCTIONS, *_MOVED_OPERANDS, *CALLS}
    names |= {"convert_element_type", "dot_general", "integer_pow", "scan"}
    return ", ".join(sorted(names))


def apply_primitive(builder: Builder, equation: JaxprEqn, operands: list[Any]) -> list[Any]:
    """Translate one primitive, element by element.

    Arguments: `operands`, arrays; those of dtype object hold operands of the program, numeric ones
    hold constants. Returns one array for each output. Raises KeyError for a primitive that cannot
    be translated, and ValueError for a use of a primitive that cannot.
    """
    primitive, params = equation.primitive.name, equation.params
    _require_reals(equation)
    if primitive in _MOVED_OPERANDS:
        return _move(equation, operands)
    operands = [_as_operands(operand) for operand in operands]
    if primitive == "convert_element_type":
        rule = _convert(equation)
    elif primitive == "integer_pow":
        rule = lambda builder, x: _power(builder, x, params["y"])  # noqa: E731 - one line
    elif primitive in _REDUCTIONS:
        return [_fold(builder, _REDUCTIONS[primitive], operands[0], params["axes"])]
    elif primitive == "dot_general":
        return [_contract(builder, params["dimension_numbers"], *operands)]
    else:
        rule = ELEMENTWISE[primitive]
    return [_elementwise(builder, rule, operands)]


def _elementwise(builder: Builder, rule: Callable[..., Operand], operands: list[Any]) -> Any:
    together = np.broadcast_arrays(*operands)
    result = np.empty(together[0].shape, dtype=object)
    for index in np.ndindex(result.shape):
        result[index] = rule(builder, *(operand[index] for operand in together))
    return result


def _fold(builder: Builder, operation: str, operand: Any, axes: tuple[int, ...]) -> Any:
    kept = [axis for axis in range(operand.ndim) if axis not in axes]
    shape = [operand.shape[axis] for axis in kept]
    rows = np.transpose(operand, [*kept, *axes]).reshape(*shape, -1)
    result = np.empty(shape, dtype=object)
    for index in np.ndindex(result.shape):
        terms: list[Operand] = list(rows[index])
        if not terms:
            raise ValueError("a reduction of nothing; allowed: at least one element")
        result[index] = reduce(partial(builder.apply, operation), terms)
    return result


def _contract(builder: Builder, dimension_numbers: Any, left: Any, right: Any) -> Any:
    (left_axes, right_axes), (left_batch, right_batch) = dimension_numbers
    if left_batch or right_batch:
        raise ValueError("a batched product; allowed: products of vectors and matrices")
    left_free = [axis for axis in range(left.ndim) if axis not in left_axes]
    right_free = [axis for axis in range(right.ndim) if axis not in right_axes]
    shape = [left.shape[i] for i in left_free] + [right.shape[i] for i in right_free]
    length = int(np.prod([left.shape[axis] for axis in left_axes]))
    rows = np.transpose(left, [*left_free, *left_axes]).reshape(-1, length)
    columns = np.transpose(right, [*right_free, *right_axes]).reshape(-1, length)
    products = _elementwise(builder, ELEMENTWISE["mul"], [rows[:, None, :], columns[None, :, :]])
    return _fold(builder, "add", products, (2,)).reshape(shape)


def evaluate_primitive(equation: JaxprEqn, operands: list[Any]) -> list[np.ndarray]:
    """Return the results of a primitive for arrays of numbers."""
    move = MOVES.get(equation.primitive.name)
    if move is not None:
        return move(operands, equation.params)
    results = equation.primitive.bind(*operands, **equation.params)
    results = results if equation.primitive.multiple_results else [results]
    return list(map(np.asarray, results))


def _move(equation: JaxprEqn, operands: list[Any]) -> list[Any]:
    positions = _MOVED_OPERANDS[equation.primitive.name] or range(len(operands))
    # Number the elements and let the primitive move the numbers: they show where each element goes.
    pool: list[Operand] = []
    arguments = list(operands)
    for position in positions:
        operand = operands[position]
        numbers = np.arange(len(pool), len(pool) + operand.size)
        arguments[position] = numbers.reshape(operand.shape)
        pool.extend(_as_operands(operand).reshape(-1))
    if any(argument.dtype == object for argument in arguments):
        raise ValueError("an index that depends on the inputs; allowed: constant indices")
    gathered = []
    for numbers in evaluate_primitive(equation, arguments):
        if numbers.size and not (numbers.min() >= 0 and numbers.max() < len(pool)):
            raise ValueError("an index out of bounds; allowed: indices inside the array")
        flat = np.empty(numbers.size, dtype=object)
        flat[:] = [pool[number] for number in numbers.reshape(-1)]
        gathered.append(flat.reshape(numbers.shape))
    return gathered


def _convert(equation: JaxprEqn) -> Callable[..., Operand]:
    old, new = _dtype(equation.invars[0]), np.dtype(equation.params["new_dtype"])
    if old.kind == "f" and new.kind in "iu":
        raise ValueError("a rounding to whole numbers; allowed: floor and ceil")
    if old.kind == "b" and new.kind != "b":
        return lambda builder, x: builder.apply("select", x, 1.0, 0.0)
    if old.kind != "b" and new.kind == "b":
        return lambda builder, x: builder.apply("ne", x, 0.0)
    return lambda builder, x: x


def _as_operands(array: Any) -> Any:
    if array.dtype == object:
        return array
    items = [bool(x) if array.dtype == np.bool_ else float(x) for x in array.reshape(-1)]
    result = np.empty(array.size, dtype=object)
    result[:] = items
    return result.reshape(array.shape)


def _require_reals(equation: JaxprEqn) -> None:
    # Exported code has no integers, so integers may only be moved, selected and converted.
    whole = equation.primitive.name in ("select_n", "convert_element_type", *_MOVED_OPERANDS)
    for variable in equation.outvars:
        dtype = _dtype(variable)
        if not (dtype in (np.float64, np.bool_) or (whole and dtype.kind in "iu")):
            raise ValueError(f"a value of type {dtype}; allowed: float64 and bool")


def _dtype(variable: Any) -> np.dtype:
    return np.dtype(variable.aval.dtype)
