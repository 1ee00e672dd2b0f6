"""Writing the values of a program as expressions in a language."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from programs.languages import Language, shortest_decimal
from programs.languages.spelling import Precedence, Spelling
from programs.printing.line_breaking import Break, Tokens, nested, on_one_line
from programs.program import Operand, Program, Step, is_value

# Operators that all languages share, unless a language has its own spelling: the sign, its
# precedence, and the least precedence with which the left and the right operand need no
# parentheses. Operands of comparisons and logic get more parentheses than a language needs, because
# the languages differ in the precedence of these operators.
_INFIX = {
    "add": ("+", Precedence.SUM, Precedence.SUM, Precedence.PRODUCT),
    "sub": ("-", Precedence.SUM, Precedence.SUM, Precedence.PRODUCT),
    "mul": ("*", Precedence.PRODUCT, Precedence.PRODUCT, Precedence.SIGN),
    "div": ("/", Precedence.PRODUCT, Precedence.PRODUCT, Precedence.SIGN),
    "lt": ("<", Precedence.COMPARISON, Precedence.SUM, Precedence.SUM),
    "le": ("<=", Precedence.COMPARISON, Precedence.SUM, Precedence.SUM),
    "gt": (">", Precedence.COMPARISON, Precedence.SUM, Precedence.SUM),
    "ge": (">=", Precedence.COMPARISON, Precedence.SUM, Precedence.SUM),
    "eq": ("==", Precedence.EQUALITY, Precedence.SUM, Precedence.SUM),
    "ne": ("!=", Precedence.EQUALITY, Precedence.SUM, Precedence.SUM),
    "and": ("&&", Precedence.LOGIC, Precedence.EQUALITY, Precedence.EQUALITY),
    "or": ("||", Precedence.LOGIC, Precedence.EQUALITY, Precedence.EQUALITY),
}
_PREFIX = {"neg": "-", "not": "!"}
# A constant with more digits than this was fitted, and goes into the pool if there is one.
_MAX_DIGITS_INLINE = 4


@dataclass(frozen=True)
class ConstantPool:
    """The constants that a function declares in an array at the start of its body, in order."""

    name: str
    places: dict[float, str] = field(default_factory=dict)

    def place(self, constant: float) -> str:
        """Return the reference to a constant, which is added to the pool if it is new."""
        return self.places.setdefault(constant, f"{self.name}[{len(self.places)}]")


@dataclass(frozen=True)
class WritingContext:
    """What is needed to write a value as code.

    `names` maps each input, and each value that has a statement of its own, to its name. `pool`
    collects the constants of many digits in the order in which they are first written; if it is
    None, they are written in place.
    """

    program: Program
    language: Language
    precision: str
    names: Mapping[int, str]
    pool: ConstantPool | None = None


def spelling(language: Language, precision: str, operation: str) -> Spelling | None:
    """Return a language's own spelling of an operation; None for an operator that all share.

    Raises ValueError for an operation that the language does not have in that precision.
    """
    functions = language.functions[precision]
    if operation in functions:
        return functions[operation]
    if operation in _INFIX or operation in _PREFIX:
        return None
    allowed = ", ".join(sorted({*functions, *_INFIX, *_PREFIX}))
    raise ValueError(
        f"{operation!r} cannot be written in {language.name} at {precision} precision; "
        f"allowed: {allowed}"
    )


def expression(context: WritingContext, operand: Operand) -> Tokens:
    """Write a value: its name if it has one, else the expression that computes it."""
    return _write(context, operand)[0]


def computation(context: WritingContext, value: int) -> Tokens:
    """Write the expression that computes a value, even if the value has a name."""
    return _compute(context, value)[0]


def literal(context: WritingContext, value: float) -> str:
    """Write a constant as a literal; raises ValueError if it is out of the precision's range."""
    try:
        digits = shortest_decimal(value, context.precision)
    except ValueError as error:
        raise ValueError(f"{context.program.name}: {error}") from None
    return context.language.literals[context.precision].format(digits)


def _write(context: WritingContext, operand: Operand) -> tuple[Tokens, int]:
    if not is_value(operand):
        if context.pool is not None and len(re.sub(r"\D", "", repr(operand))) > _MAX_DIGITS_INLINE:
            return [context.pool.place(operand)], Precedence.ATOM
        text = literal(context, operand)
        return [text], Precedence.SIGN if text.startswith("-") else Precedence.ATOM
    if operand in context.names:
        return [context.names[operand]], Precedence.ATOM
    return _compute(context, operand)


def _compute(context: WritingContext, value: int) -> tuple[Tokens, int]:
    step = context.program.steps[value - len(context.program.inputs)]
    clamp = _clamp(context, step)
    if clamp is not None:
        return clamp, Precedence.ATOM
    how = spelling(context.language, context.precision, step.operation)
    if how is not None:
        return _from_template(context, how, step.operands), how.precedence
    if step.operation in _PREFIX:
        tokens = _operand(context, step.operands[0], Precedence.SIGN)
        if on_one_line(tokens).startswith(_PREFIX[step.operation]):
            tokens = ["(", *nested(tokens), ")"]
        return [_PREFIX[step.operation], *tokens], Precedence.SIGN
    return _infix(context, step.operation, step.operands)


def _clamp(context: WritingContext, step: Step) -> Tokens | None:
    """Write max(min(x, high), low) by the language's function for it; None if it is no such step.

    For low ≤ high, min(max(x, low), high) is the same.
    """
    program, templates = context.program, context.language.clamps.get(context.precision)
    if templates is None or step.operation not in ("min", "max"):
        return None
    inner, bound = step.operands
    if not is_value(inner) or is_value(bound) or inner in context.names:
        return None
    within = program.steps[inner - len(program.inputs)]
    if within.operation != {"min": "max", "max": "min"}[step.operation]:
        return None
    operand, other = within.operands
    low, high = (bound, other) if step.operation == "max" else (other, bound)
    if not is_value(operand) or is_value(low) or is_value(high) or not low <= high:
        return None
    template = templates[(low, high) == (0.0, 1.0)]
    return _from_template(context, Spelling(template), (operand, low, high))


def _infix(
    context: WritingContext, operation: str, operands: tuple[Operand, ...]
) -> tuple[Tokens, int]:
    sign, precedence, left_precedence, right_precedence = _INFIX[operation]
    before = _operand(context, operands[0], left_precedence, chain=left_precedence == precedence)
    after = _operand(context, operands[1], right_precedence)
    first = after[0]
    if isinstance(first, str) and first.startswith("-"):
        if operation in ("add", "sub"):
            # x + (−c)·y and x − c·y are equal to the last bit; the second reads better.
            sign, after = ("-" if sign == "+" else "+"), [first[1:], *after[1:]]
        else:
            after = ["(", *nested(after), ")"]
    return [*before, f" {sign}", Break(), *nested(after)], precedence


def _operand(context: WritingContext, operand: Operand, least: int, chain: bool = False) -> Tokens:
    """Write an operand, in parentheses if its precedence is below `least`.

    In a `chain` such as a + b + c, a left operand of the same precedence is the first part of the
    chain. Its places to break are then not nested deeper than the following ones.
    """
    tokens, precedence = _write(context, operand)
    if precedence < least:
        return ["(", *nested(tokens, 2), ")"]
    return tokens if chain and precedence == least else nested(tokens)


def _from_template(context: WritingContext, how: Spelling, operands: tuple[Operand, ...]) -> Tokens:
    # Two constants to select from do not show the type of the result.
    untyped = len(operands) == 3 and not any(is_value(operand) for operand in operands[1:])
    parts = [part for part in re.split(r"(\{\d\}|, )", how.template) if part]
    tokens: Tokens = []
    for before, part, after in zip(["", *parts], parts, [*parts[1:], ""], strict=False):
        if part == ", ":
            tokens += [",", Break(1)]
        elif part in (" ? ", " : "):
            tokens += [part[:-1], Break()]
        elif part.startswith("{"):
            operand = operands[int(part[1])]
            enclosed = before.endswith(("(", ", ")) and after.startswith((")", ", "))
            least = Precedence.ARGUMENT if enclosed else how.precedence + 1
            if untyped and not is_value(operand):
                tokens += typed_expression(context, operand)
            else:
                tokens += nested(_operand(context, operand, least))
        else:
            tokens.append(part)
    return tokens


def typed_expression(context: WritingContext, operand: Operand) -> Tokens:
    """Write a value where its surroundings do not show its type, such as a returned constant."""
    tokens = expression(context, operand)
    if is_value(operand):
        return tokens
    kind = context.language.types[context.precision]
    return [context.language.typed_literal.format(on_one_line(tokens), type=kind)]
