"""A reader of equations: it parses the text of a form, and evaluates it."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fitting import Form
from fitting.equation import coefficient_symbols
from fitting.linearity import program_of
from integrals.reference import Axis
from programs import evaluate

NAME = r"[^\W\d⁰¹²³⁴⁵⁶⁷⁸⁹][^\W⁰¹²³⁴⁵⁶⁷⁸⁹]*"
_TOKEN = re.compile(rf"\s*(?:(\d+\.?\d*(?:e-?\d+)?)|({NAME})|([⁰¹²³⁴⁵⁶⁷⁸⁹]+)|(.))")
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "cos": math.cos,
    "sin": math.sin,
    "acos": math.acos,
    "exp": math.exp,
    "ln": math.log,
    "max": max,
    "min": min,
}
Known = dict[str, Any]
# The same operations in another order: rounding of some values of the size of one.
ROUNDING = 1e-12
POINTS = 60


def points_of(form: Form, count: int = POINTS) -> np.ndarray:
    return points_of_axes(form.axes, count)


def points_of_axes(axes: Sequence[Axis], count: int) -> np.ndarray:
    columns = np.random.default_rng(20).random((count, len(axes)))
    inner = [axis.place(u) for axis, u in zip(axes, columns.T, strict=True)]
    return np.stack(inner, axis=1)


def values_of_equation(form: Form, coefficients: np.ndarray, points: np.ndarray) -> np.ndarray:
    flat = np.ravel(coefficients).tolist()
    symbols = coefficient_symbols(form.coefficient_names)
    own = dict(zip(symbols, flat, strict=True)) if symbols and symbols[0] != "C[0]" else {}
    found = []
    for point in points.tolist():
        place = {axis.symbol: x for axis, x in zip(form.axes, point, strict=True)}
        found.append(value_of(form.equation, {**own, **place}, flat))
    return np.array(found)


def require_same(form: Form, coefficients: np.ndarray, points: np.ndarray) -> None:
    flat = np.tile(np.ravel(coefficients), (len(points), 1))
    expected = evaluate(program_of(form), np.concatenate([flat, points], axis=1))[:, 0]
    assert np.isfinite(expected).all()
    found = values_of_equation(form, coefficients, points)
    size = np.maximum(np.abs(expected), 1.0)
    assert np.max(np.abs(found - expected) / size) <= ROUNDING


def value_of(equation: str, known: Mapping[str, float], coefficients: Sequence[float]) -> float:
    """Return the value of the last statement of an equation.

    `known` has the values of names that the equation does not define; `coefficients` are C[0],
    C[1], … Raises ValueError for a text that does not keep to the grammar, and for a name that is
    not defined or is defined twice.
    """
    names: Known = {**known, "C": coefficients}
    result = math.nan
    for statement in equation.split("; "):
        found = re.fullmatch(rf"({NAME})(?:\(({NAME})\))? = (.+)", statement)
        if found is None:
            raise ValueError(f"no statement: {statement!r}")
        name, argument, text = found.groups()
        if name in names or name in _FUNCTIONS:
            raise ValueError(f"{name} is defined twice")
        if argument is None:
            names[name] = result = _Reader(text, names).whole()
        else:
            names[name] = _function(argument, text, dict(names))
    return result


def _function(argument: str, text: str, names: Known) -> Callable[[float], float]:
    if argument in names:
        raise ValueError(f"{argument} is an argument, and defined")
    return lambda given: _Reader(text, {**names, argument: given}).whole()


class _Reader:
    """Evaluates one expression by recursive descent."""

    def __init__(self, text: str, names: Known):
        self.tokens = [match.groups() for match in _TOKEN.finditer(text.strip())]
        self.names, self.at = names, 0

    def whole(self) -> float:
        value = self.sum()
        if self.at < len(self.tokens):
            raise ValueError(f"{self.tokens[self.at]} is left")
        return value

    def sign(self, signs: str) -> str:
        """Return the sign that comes next, and pass it, if it is one of these."""
        sign = self.tokens[self.at][3] if self.at < len(self.tokens) else None
        if sign is None or sign not in signs:
            return ""
        self.at += 1
        return sign

    def require(self, sign: str) -> None:
        if not self.sign(sign):
            raise ValueError(f"{sign} is missing at {self.tokens[self.at :]}")

    def sum(self) -> float:
        total = self.product()
        while sign := self.sign("+−"):
            total = total + self.product() if sign == "+" else total - self.product()
        return total

    def product(self) -> float:
        total = self.factor()
        while sign := self.sign("·/"):
            total = total * self.factor() if sign == "·" else total / self.factor()
        return total

    def factor(self) -> float:
        if self.sign("−"):
            return -self.factor()
        base = math.sqrt(self.atom()) if self.sign("√") else self.atom()
        raised = self.tokens[self.at][2] if self.at < len(self.tokens) else None
        if raised is None:
            return base
        self.at += 1
        return base ** int(raised.translate(_RAISED))

    def atom(self) -> float:
        if self.sign("("):
            value = self.sum()
            self.require(")")
            return value
        if self.at == len(self.tokens):
            raise ValueError("an operand is missing")
        number, name, _, _ = self.tokens[self.at]
        self.at += 1
        if number is not None:
            return float(number)
        if name is None:
            raise ValueError(f"{self.tokens[self.at - 1]} is no operand")
        return self.named(name)

    def named(self, name: str) -> float:
        if self.sign("("):
            given = [self.sum()]
            while self.sign(","):
                given.append(self.sum())
            self.require(")")
            if name not in _FUNCTIONS and not callable(self.names.get(name)):
                raise ValueError(f"{name} is no function")
            return (_FUNCTIONS.get(name) or self.names[name])(*given)
        if name not in self.names:
            raise ValueError(f"{name} is not defined")
        if self.sign("["):
            place = self.sum()
            self.require("]")
            return self.names[name][int(place)]
        return self.names[name]
