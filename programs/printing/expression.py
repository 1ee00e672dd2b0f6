"""Writing the values of a program as expressions of a language."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from programs.languages import Language, shortest_decimal
from programs.languages.spelling import Precedence, Spelling
from programs.printing.line_breaking import Break, Tokens, nested, on_one_line
from programs.program import Operand, Program, is_value

# Operations that every language here writes alike, unless its language says otherwise: the sign, how
# tightly it binds, and how tightly its operands must bind to stand without parentheses. Comparisons
# and logic never lean on precedence: there the languages differ.
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


# A constant of more digits than this is a fitted one: it goes into the pool, if there is one.
_SHORT = 4


@dataclass(frozen=True)
class ConstantPool:
    """The constants that stand in an array at the head of a function, in order."""

    name: str
    places: dict[float, str] = field(default_factory=dict)

    def place(self, constant: float) -> str:
        """Write the reference to a constant, which joins the pool if it is new."""
        return self.places.setdefault(constant, f"{self.name}[{len(self.places)}]")


@dataclass(frozen=True)
class WritingContext:
    """What is needed to write a value: its program, its language, and the names given so far.

    `names` holds the values that have a name. `pool`, where there is one, takes up the constants
    of many digits in the order in which they are first written.
    """

    program: Program
    language: Language
    precision: str
    names: Mapping[int, str]
    pool: ConstantPool | None = None


def spelling(language: Language, precision: str, operation: str) -> Spelling | None:
    """Find how a language spells an operation; None for those that are written alike everywhere.

    Raises ValueError for an operation that the language does not have at that precision.
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
    """Write a value: its name where it has one, else the expression that computes it."""
    return _write(context, operand)[0]


def computation(context: WritingContext, value: int) -> Tokens:
    """Write the expression that computes a step's value, even where it has a name."""
    return _compute(context, value)[0]


def literal(context: WritingContext, value: float) -> str:
    """Write a constant in the language and precision; raises ValueError when it has no literal."""
    try:
        digits = shortest_decimal(value, context.precision)
    except ValueError as error:
        raise ValueError(f"{context.program.name}: {error}") from None
    return context.language.literals[context.precision].format(digits)


def _write(context: WritingContext, operand: Operand) -> tuple[Tokens, int]:
    if not is_value(operand):
        if context.pool is not None and len(re.sub(r"\D", "", repr(operand))) > _SHORT:
            return [context.pool.place(operand)], Precedence.ATOM
        text = literal(context, operand)
        return [text], Precedence.SIGN if text.startswith("-") else Precedence.ATOM
    if operand in context.names:
        return [context.names[operand]], Precedence.ATOM
    return _compute(context, operand)


def _compute(context: WritingContext, value: int) -> tuple[Tokens, int]:
    step = context.program.steps[value - len(context.program.inputs)]
    how = spelling(context.language, context.precision, step.operation)
    if how is not None:
        return _from_template(context, how, step.operands), how.precedence
    if step.operation in _PREFIX:
        tokens = _bound(context, step.operands[0], Precedence.SIGN)
        if on_one_line(tokens).startswith(_PREFIX[step.operation]):
            tokens = ["(", *nested(tokens), ")"]
        return [_PREFIX[step.operation], *tokens], Precedence.SIGN
    return _infix(context, step.operation, step.operands)


def _infix(
    context: WritingContext, operation: str, operands: tuple[Operand, ...]
) -> tuple[Tokens, int]:
    sign, precedence, left_precedence, right_precedence = _INFIX[operation]
    before = _bound(context, operands[0], left_precedence, chain=left_precedence == precedence)
    after = _bound(context, operands[1], right_precedence)
    first = after[0]
    if isinstance(first, str) and first.startswith("-"):
        if operation in ("add", "sub"):
            # x + (−c)·y is x − c·y to the last bit, and better to read.
            sign, after = ("-" if sign == "+" else "+"), [first[1:], *after[1:]]
        else:
            after = ["(", *nested(after), ")"]
    return [*before, f" {sign}", Break(), *nested(after)], precedence


def _bound(context: WritingContext, operand: Operand, least: int, chain: bool = False) -> Tokens:
    """Write an operand, in parentheses when it binds less tightly than its place asks for.

    In a `chain` (a + b + c) an operand of the same precedence is the chain's beginning: its breaks
    are as welcome as the next one.
    """
    tokens, precedence = _write(context, operand)
    if precedence < least:
        return ["(", *nested(tokens, 2), ")"]
    return tokens if chain and precedence == least else nested(tokens)


def _from_template(context: WritingContext, how: Spelling, operands: tuple[Operand, ...]) -> Tokens:
    # Two constants to select from say no type by themselves.
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
                tokens += nested(_bound(context, operand, least))
        else:
            tokens.append(part)
    return tokens


def typed_expression(context: WritingContext, operand: Operand) -> Tokens:
    """Write a value that nothing around it gives a type: a bare result."""
    tokens = expression(context, operand)
    if is_value(operand):
        return tokens
    kind = context.language.types[context.precision]
    return [context.language.typed_literal.format(on_one_line(tokens), type=kind)]
