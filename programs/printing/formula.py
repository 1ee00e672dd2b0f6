"""Programs as formulas for people to read, such as 'x·(a + b·x²)/(1 + c·x²)'."""

from collections import Counter
from collections.abc import Callable, Sequence

from programs.operations import OPERATIONS
from programs.printing.identifiers import as_identifier, free_name
from programs.program import Operand, Program, interpret, is_value

# How tightly a text holds together: a sum, a product, a sign, or a name.
_SUM, _PRODUCT, _SIGN, _ATOM = range(4)
_Text = tuple[str, int]


def _inside(part: _Text, least: int) -> str:
    text, holds = part
    return text if holds >= least else f"({text})"


def _to_the_right(part: _Text, least: int) -> str:
    return f"({part[0]})" if part[0].startswith("−") else _inside(part, least)


def _infix(sign: str, holds: int, right: int) -> Callable[[_Text, _Text], _Text]:
    return lambda a, b: (f"{_inside(a, holds)}{sign}{_to_the_right(b, right)}", holds)


def _product(a: _Text, b: _Text) -> _Text:
    if a == b and a[1] == _ATOM and not a[0].endswith("²"):
        return f"{a[0]}²", _ATOM
    return _infix("·", _PRODUCT, _PRODUCT)(a, b)


def _called(name: str) -> Callable[..., _Text]:
    return lambda *parts: (f"{name}({', '.join(text for text, _ in parts)})", _ATOM)


_WRITERS: dict[str, Callable[..., _Text]] = {
    **{name: _called(name) for name in OPERATIONS},
    "add": _infix(" + ", _SUM, _SUM),
    "sub": _infix(" − ", _SUM, _PRODUCT),
    "mul": _product,
    "div": _infix("/", _PRODUCT, _SIGN),
    "neg": lambda a: (f"−{_inside(a, _SIGN)}", _SIGN),
    "sqrt": lambda a: (f"√({a[0]})", _ATOM),
    "log": lambda a: (f"ln({a[0]})", _ATOM),
}


def _number(value: float) -> _Text:
    text = repr(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(value)
    return (f"−{text[1:]}", _SIGN) if text.startswith("-") else (text, _ATOM)


def number_text(value: float | int) -> str:
    """Write a number with as many digits as it needs: '0.1', '4', '−2.5'."""
    return _number(float(value))[0]


def formulas(program: Program, names: Sequence[str]) -> list[str]:
    """Return a formula for each output of a program.

    `names` are those of the inputs in the formulas. A value that is used twice is written twice.
    """
    inputs = [(name, _ATOM) for name in names]
    return [text for text, _ in interpret(program, inputs, _WRITERS, _number)]


def definitions(program: Program, names: Sequence[str], result: str) -> str:
    """Return the only output of a program as statements 'name = formula', separated by '; '.

    A value that is used more than once gets a statement. Its name is that of the author's variable,
    or t1, t2, … The last statement defines `result`.
    """
    uses = Counter(o for step in program.steps for o in step.operands if is_value(o))
    values = [(name, _ATOM) for name in names]
    taken, found = {*names, *OPERATIONS, "ln", result}, []

    def fetch(operand: Operand) -> _Text:
        return values[operand] if is_value(operand) else _number(operand)

    for number, step in enumerate(program.steps, start=len(names)):
        written = _WRITERS[step.operation](*map(fetch, step.operands))
        if uses[number] > 1 and written[1] != _SIGN:
            name = free_name(as_identifier(step.hint or "") or "t1", taken)
            taken.add(name)
            found.append(f"{name} = {written[0]}")
            written = name, _ATOM
        values.append(written)
    (output,) = program.outputs
    return "; ".join([*found, f"{result} = {fetch(output)[0]}"])
