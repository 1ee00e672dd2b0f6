"""Building a straight-line program step by step: constants are folded and equal steps shared."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from programs.operations import OPERATIONS
from programs.program import Operand, Program, Step, is_value, subprogram


class Builder:
    """A program to which steps are added one by one.

    Operations on constants are folded, equal steps are shared, and expressions such as x·1, x·0,
    x/1, x±0, x/2, −(−x), x+(−y), abs(−x), abs(max(x, 0)), max(max(x, 1), 2) and a selection that is
    a minimum are simplified. Every simplification leaves each finite result unchanged to the last
    bit, except for the sign of a zero, and except for the cosine and sine of an arc cosine, which
    become more precise. Sums and products are therefore never re-associated.
    """

    def __init__(self, inputs: Sequence[str], limit: int, keep_undefined: bool = False):
        """Start an empty program with these names of inputs and at most `limit` steps.

        With `keep_undefined`, a step that may be undefined is not folded away: an operation on
        constants whose result is not finite, and x·0.
        """
        self.inputs = tuple(inputs)
        self.limit = limit
        self.keep_undefined = keep_undefined
        self.steps: list[Step] = []
        self._known: dict[tuple[Any, ...], int] = {}

    def apply(self, operation: str, *operands: Operand) -> Operand:
        """Add one operation and return its result, as an operand for further operations.

        Arguments: `operation`, a key of OPERATIONS; `operands`, numbers of values (int) or
        constants (float, or bool for conditions). Raises ValueError when the program would have
        more steps than its limit.
        """
        if not any(is_value(operand) for operand in operands):
            with np.errstate(all="ignore"):
                # With one-element arrays, np.where and the ufuncs return the same type.
                folded = OPERATIONS[operation].numpy(*(np.asarray([x]) for x in operands)).item()
            if not self.keep_undefined or np.isfinite(folded):
                return folded
            return self._append(operation, operands)
        if operation in ("min", "max") and not is_value(operands[0]):
            # In C, where these are comparisons, the second operand is the result for NaN.
            operands = operands[::-1]
        simpler = self._simplify(operation, operands)
        return self._append(operation, operands) if simpler is None else simpler

    def name(self, operand: Operand, hint: str) -> None:
        """Record the author's name of a value, unless it is an input or already has a name."""
        index = operand - len(self.inputs) if is_value(operand) else -1
        if index >= 0 and self.steps[index].hint is None:
            self.steps[index] = replace(self.steps[index], hint=hint)

    def finish(self, name: str, outputs: Sequence[Operand]) -> Program:
        """Return the program of the steps that the outputs need, renumbered."""
        return subprogram(Program(name, self.inputs, tuple(self.steps), ()), outputs)

    def _append(self, operation: str, operands: tuple[Operand, ...]) -> int:
        # The type and repr tell the constant 1.0 from the value number 1, and 0.0 from -0.0.
        tagged = [(type(operand).__name__, repr(operand)) for operand in operands]
        if OPERATIONS[operation].commutative:
            tagged.sort()
        key = (operation, *tagged)
        if key not in self._known:
            if len(self.steps) >= self.limit:
                raise ValueError(
                    f"the program has more than {self.limit} steps; allowed: at most {self.limit}"
                )
            self._known[key] = len(self.inputs) + len(self.steps)
            self.steps.append(Step(operation, operands))
        return self._known[key]

    def _simplify(self, operation: str, operands: tuple[Operand, ...]) -> Operand | None:
        if operation in ("add", "mul", "and", "or", "min", "max") and not is_value(operands[0]):
            constant, value = operands
        else:
            constant, value = operands[-1], operands[0]
        simplest: Operand | None = None
        if (operation, constant) in _NEUTRAL and not is_value(constant):
            simplest = value
        elif (operation, constant) in _ABSORBING and not is_value(constant):
            simplest = None if operation == "mul" and self.keep_undefined else constant
        elif operation in ("mul", "div") and constant == -1.0 and not is_value(constant):
            simplest = self.apply("neg", value)
        elif operation == "div" and not is_value(constant) and _is_power_of_two(constant):
            simplest = self.apply("mul", 1.0 / constant, value)
        elif operation == "sub" and operands[0] == 0.0 and not is_value(operands[0]):
            simplest = self.apply("neg", operands[1])
        elif operation in ("min", "max", "and", "or") and _same(*operands):
            simplest = operands[0]
        elif operation in ("min", "max") and not is_value(constant):
            simplest = self._simplify_bounds(operation, value, constant)
        elif operation == "select":
            simplest = self._simplify_selection(*operands)
        elif operation in ("cos", "sin"):
            simplest = self._simplify_angle(operation, operands[0])
        else:
            simplest = self._simplify_signs(operation, operands)
        return simplest

    def _simplify_selection(self, condition: Operand, yes: Operand, no: Operand) -> Operand | None:
        if not is_value(condition):
            return yes if condition else no
        if _same(yes, no):
            return yes
        inner = self._operand_of("not", condition)
        if inner is not None:
            return self.apply("select", inner, no, yes)
        return self._simplify_bound(condition, yes, no)

    def _simplify_bound(self, condition: int, yes: Operand, no: Operand) -> Operand | None:
        """Recognise minima and maxima: where(a < b, b, a) is max(a, b)."""
        index = condition - len(self.inputs)
        if index < 0 or self.steps[index].operation not in _MINIMA_AND_MAXIMA:
            return None
        left, right = self.steps[index].operands
        smaller, larger = _MINIMA_AND_MAXIMA[self.steps[index].operation]
        if _same(yes, left) and _same(no, right):
            return self.apply(smaller, left, right)
        if _same(yes, right) and _same(no, left):
            return self.apply(larger, left, right)
        return None

    def _simplify_angle(self, operation: str, angle: Operand) -> Operand | None:
        """Make cos(acos(x)) x, and sin(acos(x)) the root of 1 − x²: no angle is needed."""
        cosine = self._operand_of("acos", angle)
        if cosine is None or operation == "cos":
            return cosine
        factors = self.apply("sub", 1.0, cosine), self.apply("add", 1.0, cosine)
        return self.apply("sqrt", self.apply("mul", *factors))

    def _simplify_bounds(self, operation: str, value: Operand, bound: float) -> Operand | None:
        """Make one bound of two: max(max(x, 1), 2) is max(x, 2)."""
        inner = self._bound_of(operation, value)
        if inner is None:
            return None
        operand, other = inner
        tighter = max(bound, other) if operation == "max" else min(bound, other)
        return value if tighter == other else self.apply(operation, operand, tighter)

    def _bound_of(self, operation: str, value: Operand) -> tuple[Operand, float] | None:
        """Return x and b if `value` is operation(x, b) with a constant b, else None."""
        index = value - len(self.inputs) if is_value(value) else -1
        if index < 0 or self.steps[index].operation != operation:
            return None
        operand, bound = self.steps[index].operands
        return None if is_value(bound) else (operand, bound)

    def _simplify_signs(self, operation: str, operands: tuple[Operand, ...]) -> Operand | None:
        bare = [self._operand_of("neg", operand) for operand in operands]
        result: Operand | None = None
        if operation == "neg":
            result = bare[0]
        elif operation == "not":
            result = self._operand_of("not", operands[0])
        elif operation == "abs" and bare[0] is not None:
            result = self.apply("abs", bare[0])
        elif operation == "abs":
            lower = self._bound_of("max", operands[0])
            result = operands[0] if lower is not None and lower[1] >= 0 else None
        elif operation == "add" and bare[1] is not None:
            result = self.apply("sub", operands[0], bare[1])
        elif operation == "add" and bare[0] is not None:
            result = self.apply("sub", operands[1], bare[0])
        elif operation == "sub" and bare[1] is not None:
            result = self.apply("add", operands[0], bare[1])
        elif operation in ("mul", "div") and bare[0] is not None and bare[1] is not None:
            result = self.apply(operation, bare[0], bare[1])
        return result

    def _operand_of(self, operation: str, operand: Operand) -> Operand | None:
        """Return x if `operand` is operation(x), else None."""
        index = operand - len(self.inputs) if is_value(operand) else -1
        if index < 0 or self.steps[index].operation != operation:
            return None
        return self.steps[index].operands[0]


# comparison of a and b -> the meaning of where(comparison, a, b) and of where(comparison, b, a)
_MINIMA_AND_MAXIMA = {
    "lt": ("min", "max"),
    "le": ("min", "max"),
    "gt": ("max", "min"),
    "ge": ("max", "min"),
}
# (operation, constant operand) for which the result is the other operand
_NEUTRAL = {
    ("add", 0.0),
    ("sub", 0.0),
    ("mul", 1.0),
    ("div", 1.0),
    ("pow", 1.0),
    ("and", True),
    ("or", False),
}
# (operation, constant operand) for which the result is the constant
_ABSORBING = {("mul", 0.0), ("and", False), ("or", True)}


def _is_power_of_two(constant: float) -> bool:
    # Dividing by such a constant and multiplying by its reciprocal give the same bits. The range is
    # that of half precision, in which the reciprocal must be exact too.
    return abs(math.frexp(constant)[0]) == 0.5 and 2.0**-10 <= abs(constant) <= 2.0**10


def _same(one: Operand, other: Operand) -> bool:
    return type(one) is type(other) and one == other
