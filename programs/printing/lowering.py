"""Operations that a language does not have, written by ones that it has.

`expm1` and `log1p` are missing in most shading languages. Near zero, where exp(x) − 1 and
log(1 + x) would lose all digits, series are evaluated instead. They are accurate to float32.
"""

from collections.abc import Callable, Collection
from math import factorial

from programs.program import Operand, Program, is_value
from programs.tracing.builder import Builder

# |x| from which exp(x) − 1 and log(1 + x) lose no more than two bits.
_NEAR_ZERO = 0.5
# Terms that leave a relative error below 2e-8 there.
_EXPM1_TERMS, _LOG1P_TERMS = 9, 7


def lowered(program: Program, available: Collection[str]) -> Program:
    """Return a program of available operations that computes the same.

    A missing operation without a rule is left in place: whoever prints the program refuses it. A
    program that lacks nothing is returned as it is.
    """
    missing = {step.operation for step in program.steps} & RULES.keys() - set(available)
    if not missing:
        return program
    builder = Builder(program.inputs, limit=2 * len(program.steps) + 100)
    values: list[Operand] = list(range(len(program.inputs)))

    def moved(operand: Operand) -> Operand:
        return values[operand] if is_value(operand) else operand

    for step in program.steps:
        operands = [moved(operand) for operand in step.operands]
        rule = RULES[step.operation] if step.operation in missing else None
        result = builder.apply(step.operation, *operands) if rule is None else rule(
            builder, *operands
        )  # fmt: skip
        if step.hint is not None:
            builder.name(result, step.hint)
        values.append(result)
    return builder.finish(program.name, [moved(operand) for operand in program.outputs])


def _expm1(builder: Builder, x: Operand) -> Operand:
    """Return x (1 + x/2 + x²/6 + …) near zero, else exp(x) − 1."""
    coefficients = [1 / factorial(k) for k in range(1, _EXPM1_TERMS + 1)]
    near = builder.apply("mul", x, _horner(builder, coefficients, x))
    return _either(builder, x, near, builder.apply("sub", builder.apply("exp", x), 1.0))


def _log1p(builder: Builder, x: Operand) -> Operand:
    """Return 2s (1 + s²/3 + s⁴/5 + …) with s = x/(2 + x) near zero, else log(1 + x)."""
    ratio = builder.apply("div", x, builder.apply("add", 2.0, x))
    square = builder.apply("mul", ratio, ratio)
    coefficients = [2 / (2 * k + 1) for k in range(_LOG1P_TERMS)]
    near = builder.apply("mul", ratio, _horner(builder, coefficients, square))
    return _either(builder, x, near, builder.apply("log", builder.apply("add", 1.0, x)))


def _horner(builder: Builder, coefficients: list[float], x: Operand) -> Operand:
    total: Operand = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        total = builder.apply("add", coefficient, builder.apply("mul", x, total))
    return total


def _either(builder: Builder, x: Operand, near: Operand, far: Operand) -> Operand:
    is_near = builder.apply("lt", builder.apply("abs", x), _NEAR_ZERO)
    return builder.apply("select", is_near, near, far)


# operation -> what stands for it
RULES: dict[str, Callable[..., Operand]] = {"expm1": _expm1, "log1p": _log1p}
