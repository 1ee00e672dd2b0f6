"""The bound of rounding at a point: the sum of derivatives, which 40 digits give for each rule."""

import functools

import mpmath
import pytest

from programs.bounding.adjoints import _RULES
from programs.bounding.compiled import compiler_missing
from programs.bounding.rounding_model import IEEE, ULP
from programs.operations import OPERATIONS
from programs.program import Program, Step
from tests.programs.kernels import rounding_kernels_of

# The functions of all operations take four seconds to compile.
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler"),
]

EXACT = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "abs": abs,
    "rsqrt": lambda a: 1 / mpmath.sqrt(a),
    "max": lambda a, b: a if a > b else b,
    "min": lambda a, b: a if a < b else b,
    "exp2": lambda a: mpmath.mpf(2) ** a,
    "pow": lambda a, b: a**b,
    # The condition, x < y, holds.
    "select": lambda a, b: a,
}
# x and y: the operands are x·y and x + y, each of which is rounded.
POINTS = ((0.25, 0.625), (0.375, 2.0), (-0.75, 0.5))
DEFINED = {name: POINTS[:2] for name in ("sqrt", "rsqrt", "log", "pow")}
DEFINED["atan2"] = ((-0.25, 0.625), (0.25, 0.625))


def program_of(operation: str) -> Program:
    arity = OPERATIONS[operation].arity
    steps = [Step("mul", (0, 1)), Step("add", (0, 1)), Step("lt", (0, 1))]
    operands = (4, 2, 3) if operation == "select" else (2, 3)[:arity]
    steps.append(Step(operation, operands))
    return Program(operation, ("x", "y"), tuple(steps), (5,))


@functools.cache
def kernels() -> rounding_kernels_of:
    return rounding_kernels_of({name: program_of(name) for name in _RULES}, IEEE, 2)


def expected(operation: str, x: float, y: float):
    exact = EXACT.get(operation) or getattr(mpmath, operation)
    operands = (mpmath.mpf(x) * y, mpmath.mpf(x) + y)
    both = operation == "select" or OPERATIONS[operation].arity == 2
    operands = operands if both else operands[:1]
    total = IEEE.errors[operation].ulps * abs(exact(*operands))
    for k, operand in enumerate(operands):
        order = tuple(int(j == k) for j in range(len(operands)))
        total += 0.5 * abs(operand * mpmath.diff(exact, operands, order, h=1e-9))
    return total * ULP


@pytest.mark.parametrize("operation", _RULES)
def test_a_bound_is_the_sum_of_derivatives(operation):
    with mpmath.workdps(40):
        for point in DEFINED.get(operation, POINTS):
            if operation in ("asin", "acos", "log1p") and point[0] < 0:
                continue
            bounds = kernels()(operation, point, point)
            exact = expected(operation, *point)
            # Terms of the second order, and the product, which may be fused with a sum
            assert exact <= bounds[1] <= exact * (1 + 1e-5) + 1e-30
