"""What is derived from a form's traced program: its linear parts, and what must stay positive.

Many forms are quotients (a₀ + a·c)/(b₀ + b·c), whose numerator and denominator are linear in the
coefficients c. To find out, the program is evaluated with such quotients in place of numbers: each
coefficient enters as the quotient cₖ/1, and each operation either returns a quotient or fails.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form
from programs.bounding.denominators import ALLOWED, operands
from programs.functions import Function, Parameter
from programs.jax_operations import JAX_OPERATIONS
from programs.operations import OPERATIONS
from programs.program import Program, evaluate, interpret, subprogram
from programs.tracing.tracer import trace

# The sign of a divisor is found at this many points. An infinite end is replaced by `_FAR`.
_PROBES, _FAR = 16, 1e6
# Tracing needs a range for every input, but nothing here depends on it.
_ANY = (-1.0, 1.0)


@dataclass(frozen=True)
class LinearParts:
    """The parts of (a₀ + a·c)/(b₀ + b·c) at n points: a₀, b₀ (n,) and a, b (n, coefficients)."""

    a0: np.ndarray
    a: np.ndarray
    b0: np.ndarray
    b: np.ndarray

    @property
    def is_linear(self) -> bool:
        """Whether the denominator has no coefficient."""
        return not np.any(self.b)

    def some(self, points: np.ndarray) -> "LinearParts":
        """Return the parts at some of the points, by their numbers or a mask."""
        return LinearParts(self.a0[points], self.a[points], self.b0[points], self.b[points])

    def values(self, c: np.ndarray) -> np.ndarray:
        """Return the values (n,) for coefficients c."""
        return (self.a0 + self.a @ c) / (self.b0 + self.b @ c)

    def values_and_slopes(self, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the values (n,) for coefficients c, and their derivatives (n, coefficients)."""
        below = self.b0 + self.b @ c
        values = (self.a0 + self.a @ c) / below
        return values, (self.a - values[:, None] * self.b) / below[:, None]


@functools.lru_cache(maxsize=64)
def program_of(form: Form) -> Program:
    """Trace a form. The inputs of the program are the flat coefficients, then the axes."""
    # An axis may be called c.
    coefficients = Parameter("coefficients__", _ANY, size=form.size) if form.size else None
    points = tuple(Parameter(axis.name, _ANY) for axis in form.axes)

    def call(*arguments):
        if coefficients is None:
            return form(jnp.zeros(0), *arguments)
        c, *point = arguments
        return form(jnp.stack(c).reshape(form.coefficient_shape), *point)

    parameters = points if coefficients is None else (coefficients, *points)
    # A fit may ask for the program while JAX traces the fit: the program's constants stay numbers.
    with jax.ensure_compile_time_eval():
        return trace(
            Function(form.name.replace("-", "_"), form.equation, parameters, None, "v", call)
        )


def linear_parts(form: Form, points: np.ndarray) -> LinearParts | None:
    """Return the linear parts of a form at points (n, axes); None if it is no such quotient."""
    size = form.size
    inputs = [*(_Quotient.coefficient(k) for k in range(size)), *points.T]
    try:
        with np.errstate(all="ignore"):
            (found,) = interpret(program_of(form), inputs, _RULES, float)
    except _NotLinear:
        return None
    quotient = _Quotient.of(found)
    a0, a = quotient.above.columns(len(points), size)
    b0, b = quotient.below.columns(len(points), size)
    return LinearParts(a0, a, b0, b)


class _NotLinear(Exception):
    """The result of an operation is not a quotient of linear functions of the coefficients."""


@dataclass(frozen=True)
class _Affine:
    """constant + Σ slopes[k]·cₖ; the constant and the slopes are arrays (n,) or scalars."""

    constant: Any
    slopes: dict[int, Any]

    def columns(self, count: int, size: int) -> tuple[np.ndarray, np.ndarray]:
        matrix = np.zeros((count, size))
        for k, slope in self.slopes.items():
            matrix[:, k] = slope
        return np.broadcast_to(np.asarray(self.constant, float), (count,)).copy(), matrix

    def scaled(self, factor: Any) -> "_Affine":
        slopes = {k: slope * factor for k, slope in self.slopes.items()}
        return _Affine(self.constant * factor, slopes)

    def plus(self, other: "_Affine", sign: float) -> "_Affine":
        slopes = dict(self.slopes)
        for k, slope in other.slopes.items():
            slopes[k] = slopes[k] + sign * slope if k in slopes else sign * slope
        return _Affine(self.constant + sign * other.constant, slopes)


@dataclass(frozen=True)
class _Quotient:
    above: _Affine
    below: _Affine

    @staticmethod
    def coefficient(index: int) -> "_Quotient":
        return _Quotient(_Affine(0.0, {index: 1.0}), _ONE)

    @staticmethod
    def of(value: Any) -> "_Quotient":
        return value if isinstance(value, _Quotient) else _Quotient(_Affine(value, {}), _ONE)


_ONE = _Affine(1.0, {})


def _sum(sign: float):
    def combine(one: Any, other: Any) -> _Quotient:
        left, right = _Quotient.of(one), _Quotient.of(other)
        if left.below is right.below:
            return _Quotient(left.above.plus(right.above, sign), left.below)
        # One operand has the denominator 1 and no coefficient: it is multiplied by the other's
        # denominator.
        if right.below is _ONE and not right.above.slopes:
            lifted = left.below.scaled(right.above.constant)
            return _Quotient(left.above.plus(lifted, sign), left.below)
        if left.below is _ONE and not left.above.slopes:
            lifted = right.below.scaled(left.above.constant)
            return _Quotient(lifted.plus(right.above, sign), right.below)
        raise _NotLinear

    return combine


def _product(one: Any, other: Any) -> _Quotient:
    left, right = _Quotient.of(one), _Quotient.of(other)
    for factor, rest in ((left, right), (right, left)):
        if factor.below is _ONE and not factor.above.slopes:
            return _Quotient(rest.above.scaled(factor.above.constant), rest.below)
    raise _NotLinear


def _division(one: Any, other: Any) -> _Quotient:
    left, right = _Quotient.of(one), _Quotient.of(other)
    if right.below is not _ONE:
        raise _NotLinear
    if not right.above.slopes:
        # NumPy divides an array by zero, but Python raises an error for a number.
        if np.ndim(right.above.constant) == 0 and right.above.constant == 0:
            raise _NotLinear
        return _Quotient(left.above.scaled(1 / right.above.constant), left.below)
    if left.below is _ONE:
        return _Quotient(left.above, right.above)
    raise _NotLinear


def _lifted(name: str) -> Callable[..., Any]:
    """Return an operation that takes numbers and quotients.

    Numbers go to NumPy. Quotients go to the operation's rule, and _NotLinear is raised if it has
    none.
    """
    rules = {
        "add": _sum(1.0),
        "sub": _sum(-1.0),
        "mul": _product,
        "div": _division,
        "neg": lambda x: _product(-1.0, x),
    }

    def apply(*values: Any) -> Any:
        if not any(isinstance(value, _Quotient) for value in values):
            return OPERATIONS[name].numpy(*map(np.asarray, values))
        if name not in rules:
            raise _NotLinear
        return rules[name](*values)

    return apply


_RULES = {name: _lifted(name) for name in OPERATIONS}


@functools.lru_cache(maxsize=64)
def derived_positive(form: Form) -> Callable[..., Array]:
    """Return a function of coefficients and a point whose value must stay positive.

    It is the least of the divisors, radicands and arguments of logarithms in the form's program, as
    far as they depend on a coefficient. A divisor that is a square root is left out, because its
    radicand is among them. A divisor that is negative at the form's start stays negative.
    """
    program = program_of(form)
    found = {
        operand
        for operation, place in (("div", 1), *((name, 0) for name in ALLOWED))
        for operand in operands(program, operation, place)
    }
    first, size = len(program.inputs), form.size
    held = _holding(program, size)
    chosen = [
        value
        for value in sorted(found)
        if value in held
        and not (value >= first and program.steps[value - first].operation == "sqrt")
    ]
    wanted = subprogram(program, chosen)
    divisors = operands(program, "div", 1)
    signs = [
        -1.0 if value in divisors and negative else 1.0
        for value, negative in zip(chosen, _negative_at_start(form, wanted), strict=True)
    ]

    def positive(coefficients, *point) -> Array:
        if not chosen:
            return jnp.ones(())
        inputs = [*(jnp.ravel(coefficients)[k] for k in range(size)), *map(jnp.asarray, point)]
        found = interpret(wanted, inputs, JAX_OPERATIONS, jnp.asarray)
        signed = [value if sign > 0 else -value for value, sign in zip(found, signs, strict=True)]
        return functools.reduce(jnp.minimum, signed)

    return positive


def _negative_at_start(form: Form, program: Program) -> np.ndarray:
    """Return whether each output is negative at the form's first start, at most of some points."""
    if not (form.starts and program.outputs):
        return np.zeros(len(program.outputs), bool)
    fractions = np.linspace(0.05, 0.95, _PROBES)
    ends = [(max(a.lower, -_FAR), min(a.upper, _FAR)) for a in form.axes]
    points = np.stack([low + (high - low) * fractions for low, high in ends], axis=1)
    start = np.tile(np.ravel(form.starts[0]), (_PROBES, 1))
    values = evaluate(program, np.concatenate([start, points], axis=1))
    return np.mean(values < 0, axis=0) > 0.5


def positive_of(form: Form) -> Callable[..., Array]:
    """Return the function that a fit keeps positive: the form's own, or else the derived one."""
    return form.proofs.positive or derived_positive(form)


def _holding(program: Program, size: int) -> set[int]:
    """Return the values of a program that depend on one of its first `size` inputs."""
    held = set(range(size))
    for number, step in enumerate(program.steps, start=len(program.inputs)):
        if any(type(operand) is int and operand in held for operand in step.operands):
            held.add(number)
    return held
