"""Writing the values of a program as expressions of a language."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from programs.languages import Target, shortest
from programs.languages.language import Binding, Spelling
from programs.printing.line_breaking import Break, Tokens, deeper, flat
from programs.program import Operand, Program, is_value

# Operations that every language here writes alike, unless its target says otherwise: the sign, how
# tightly it binds, and how tightly its operands must bind to stand without parentheses. Comparisons
# and logic never lean on precedence: there the languages differ.
_INFIX = {
    "add": ("+", Binding.SUM, Binding.SUM, Binding.PRODUCT),
    "sub": ("-", Binding.SUM, Binding.SUM, Binding.PRODUCT),
    "mul": ("*", Binding.PRODUCT, Binding.PRODUCT, Binding.SIGN),
    "div": ("/", Binding.PRODUCT, Binding.PRODUCT, Binding.SIGN),
    "lt": ("<", Binding.COMPARISON, Binding.SUM, Binding.SUM),
    "le": ("<=", Binding.COMPARISON, Binding.SUM, Binding.SUM),
    "gt": (">", Binding.COMPARISON, Binding.SUM, Binding.SUM),
    "ge": (">=", Binding.COMPARISON, Binding.SUM, Binding.SUM),
    "eq": ("==", Binding.EQUALITY, Binding.SUM, Binding.SUM),
    "ne": ("!=", Binding.EQUALITY, Binding.SUM, Binding.SUM),
    "and": ("&&", Binding.LOGIC, Binding.EQUALITY, Binding.EQUALITY),
    "or": ("||", Binding.LOGIC, Binding.EQUALITY, Binding.EQUALITY),
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
class Wording:
    """What is needed to write a value: its program, its language, and the names given so far.

    `names` holds the values that have a name. `pool`, where there is one, takes up the constants
    of many digits in the order in which they are first written.
    """

    program: Program
    target: Target
    precision: str
    names: Mapping[int, str]
    pool: ConstantPool | None = None


def spelling(target: Target, precision: str, operation: str) -> Spelling | None:
    """Find how a language spells an operation; None for those that are written alike everywhere.

    Raises ValueError for an operation that the language does not have at that precision.
    """
    functions = target.functions[precision]
    if operation in functions:
        return functions[operation]
    if operation in _INFIX or operation in _PREFIX:
        return None
    allowed = ", ".join(sorted({*functions, *_INFIX, *_PREFIX}))
    raise ValueError(
        f"{operation!r} cannot be written in {target.name} at {precision} precision; "
        f"allowed: {allowed}"
    )


def expression(wording: Wording, operand: Operand) -> Tokens:
    """Write a value: its name where it has one, else the expression that computes it."""
    return _write(wording, operand)[0]


def computation(wording: Wording, value: int) -> Tokens:
    """Write the expression that computes a step's value, even where it has a name."""
    return _compute(wording, value)[0]


def literal(wording: Wording, value: float) -> str:
    """Write a constant in the language and precision; raises ValueError when it has no literal."""
    try:
        digits = shortest(value, wording.precision)
    except ValueError as error:
        raise ValueError(f"{wording.program.name}: {error}") from None
    return wording.target.literals[wording.precision].format(digits)


def _write(wording: Wording, operand: Operand) -> tuple[Tokens, int]:
    if not is_value(operand):
        if wording.pool is not None and len(re.sub(r"\D", "", repr(operand))) > _SHORT:
            return [wording.pool.place(operand)], Binding.ATOM
        text = literal(wording, operand)
        return [text], Binding.SIGN if text.startswith("-") else Binding.ATOM
    if operand in wording.names:
        return [wording.names[operand]], Binding.ATOM
    return _compute(wording, operand)


def _compute(wording: Wording, value: int) -> tuple[Tokens, int]:
    step = wording.program.steps[value - len(wording.program.inputs)]
    how = spelling(wording.target, wording.precision, step.operation)
    if how is not None:
        return _from_template(wording, how, step.operands), how.binding
    if step.operation in _PREFIX:
        tokens = _bound(wording, step.operands[0], Binding.SIGN)
        if flat(tokens).startswith(_PREFIX[step.operation]):
            tokens = ["(", *deeper(tokens), ")"]
        return [_PREFIX[step.operation], *tokens], Binding.SIGN
    return _infix(wording, step.operation, step.operands)


def _infix(wording: Wording, operation: str, operands: tuple[Operand, ...]) -> tuple[Tokens, int]:
    sign, binding, left_binding, right_binding = _INFIX[operation]
    before = _bound(wording, operands[0], left_binding, chain=left_binding == binding)
    after = _bound(wording, operands[1], right_binding)
    first = after[0]
    if isinstance(first, str) and first.startswith("-"):
        if operation in ("add", "sub"):
            # x + (−c)·y is x − c·y to the last bit, and better to read.
            sign, after = ("-" if sign == "+" else "+"), [first[1:], *after[1:]]
        else:
            after = ["(", *deeper(after), ")"]
    return [*before, f" {sign}", Break(), *deeper(after)], binding


def _bound(wording: Wording, operand: Operand, least: int, chain: bool = False) -> Tokens:
    """Write an operand, in parentheses when it binds less tightly than its place asks for.

    In a `chain` (a + b + c) an operand of the same binding is the chain's beginning: its breaks
    are as welcome as the next one.
    """
    tokens, binding = _write(wording, operand)
    if binding < least:
        return ["(", *deeper(tokens, 2), ")"]
    return tokens if chain and binding == least else deeper(tokens)


def _from_template(wording: Wording, how: Spelling, operands: tuple[Operand, ...]) -> Tokens:
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
            least = Binding.ARGUMENT if enclosed else how.binding + 1
            if untyped and not is_value(operand):
                tokens += lone_expression(wording, operand)
            else:
                tokens += deeper(_bound(wording, operand, least))
        else:
            tokens.append(part)
    return tokens


def lone_expression(wording: Wording, operand: Operand) -> Tokens:
    """Write a value that nothing around it gives a type: a bare result."""
    tokens = expression(wording, operand)
    if is_value(operand):
        return tokens
    kind = wording.target.types[wording.precision]
    return [wording.target.lone_literal.format(flat(tokens), type=kind)]
