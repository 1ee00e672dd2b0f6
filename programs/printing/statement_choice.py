"""Which values of a program get a statement of their own, and what they are called."""

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass

from programs.languages import Language
from programs.printing.expression import spelling
from programs.printing.identifiers import as_identifier, descriptive_name, free_name
from programs.program import Operand, Program, is_value

# The longest expression that is still read at a glance, in operations.
LONGEST = 48
# The most calls that are read inside each other.
DEEPEST = 4
# The author's name for a value that is used once is kept from this many operations on.
WORTH_A_NAME = 3


@dataclass(frozen=True)
class Statements:
    """The values that are written as statements, in order, and the names of all named values."""

    values: tuple[int, ...]
    names: dict[int, str]


def choose_statements(
    program: Program,
    input_texts: tuple[str, ...],
    language: Language,
    precision: str,
    taken: Collection[str],
) -> Statements:
    """Decide which values are named: those used twice, those too long to stand inside another.

    Arguments: `input_texts`, how each input is written (`alpha`, `c[0]`); `taken`, names that are
    not free. Returns the statements. Raises ValueError for an operation that the language lacks.
    """
    first = len(program.inputs)
    uses = Counter(o for step in program.steps for o in step.operands if is_value(o))
    uses.update(o for o in program.outputs if is_value(o))
    repeated = _repeated(program, language, precision)
    names = dict(enumerate(input_texts))
    used = set(taken)
    sizes: dict[int, int] = {}
    depths: dict[int, int] = {}
    chosen = []
    for value, step in enumerate(program.steps, start=first):
        inner = [o for o in step.operands if is_value(o) and o not in names]
        sizes[value] = size = 1 + sum(sizes[o] for o in inner)
        is_call = spelling(language, precision, step.operation) is not None
        depths[value] = depth = is_call + max((depths[o] for o in inner), default=0)
        is_output = any(is_value(o) and o == value for o in program.outputs)
        # A sign before a name costs nothing and says more than another name.
        bare_sign = step.operation == "neg" and size == 1
        selection = step.operation in ("min", "max", "select")
        authored = step.hint is not None and not is_output and (selection or size >= WORTH_A_NAME)
        too_much = size > LONGEST or depth > DEEPEST
        if value in repeated or too_much or authored or (uses[value] > 1 and not bare_sign):
            wanted = _wanted_name(program, value, names) or repeated.get(value) or "t"
            names[value] = free_name(wanted, used)
            used.add(names[value])
            chosen.append(value)
    return Statements(tuple(chosen), names)


def _repeated(program: Program, language: Language, precision: str) -> dict[int, str | None]:
    """Find the values that are written more than once where they are used once, and name them.

    (A minimum that is spelled as a comparison writes its operands twice.)
    """
    found: dict[int, str | None] = {}
    for step in program.steps:
        how = spelling(language, precision, step.operation)
        if how is not None and how.atoms:
            name = as_identifier(step.hint or "")
            for operand in step.operands:
                if is_value(operand) and operand >= len(program.inputs):
                    found[operand] = f"{name}Raw" if name else None
    return found


def _wanted_name(program: Program, value: int, names: dict[int, str]) -> str | None:
    step = program.steps[value - len(program.inputs)]
    hint = as_identifier(step.hint or "")
    if hint in program.inputs and step.operation in ("min", "max"):
        # alpha = clip(alpha, …): an argument and its clamped value need two names.
        return f"{hint}Clamped"
    return hint or _description(program, value, names)


def _description(program: Program, value: int, names: dict[int, str]) -> str | None:
    step = program.steps[value - len(program.inputs)]

    def name(operand: Operand) -> str | None:
        if not is_value(operand):
            return None
        if operand in names:
            return as_identifier(names[operand])
        # b·b has no name where b·b·b is all that it is used for, but it is b2 for all that.
        inner = program.steps[operand - len(program.inputs)]
        return _description(program, operand, names) if inner.operation == "mul" else None

    return descriptive_name(step, tuple(map(name, step.operands)))
